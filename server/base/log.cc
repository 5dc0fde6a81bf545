#include "server/base/log.h"

#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

namespace rmlcell::server {
namespace {

// The message as a JSON text without its quotes: a file name in a message must not break the line.
class EscapedMessage final : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm&,
              spdlog::memory_buf_t& out) override {
    for (const char c : message.payload) {
      if (c == '"' || c == '\\') {
        out.push_back('\\');
        out.push_back(c);
      } else if (static_cast<unsigned char>(c) < 0x20) {
        out.push_back(' ');
      } else {
        out.push_back(c);
      }
    }
  }
  std::unique_ptr<custom_flag_formatter> clone() const override {
    return std::make_unique<EscapedMessage>();
  }
};

}  // namespace

Status StartLog(const std::string& who, const std::string& level, const std::string& format,
                const std::string& file) {
  std::shared_ptr<spdlog::logger> logger;
  try {
    logger = file.empty() ? spdlog::stderr_logger_mt(who) : spdlog::basic_logger_mt(who, file);
  } catch (const spdlog::spdlog_ex& error) {
    return Error{ErrorCode::kCellFileUnwritable, error.what(), {}};
  }
  auto formatter = std::make_unique<spdlog::pattern_formatter>();
  formatter->add_flag<EscapedMessage>('*');
  formatter->set_pattern(
      format == "json"
          ? R"({"time":"%Y-%m-%dT%H:%M:%S.%e%z","level":"%l","who":"%n","process":%P,"message":"%*"})"
          : "%Y-%m-%d %H:%M:%S.%e %l [%n %P] %*");
  logger->set_formatter(std::move(formatter));
  logger->set_level(spdlog::level::from_str(level));
  logger->flush_on(spdlog::level::info);
  spdlog::set_default_logger(std::move(logger));
  return {};
}

}  // namespace rmlcell::server
