#include "server/web/http_session.h"

#include <netinet/tcp.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <boost/asio/dispatch.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/buffer_body.hpp>
#include <boost/beast/http/error.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <charconv>
#include <chrono>
#include <ctime>
#include <limits>
#include <utility>

#include "engine/core/letters.h"
#include "server/web/refused_connection.h"
#include "server/web/rpc_codec.h"

namespace rmlcell::web {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using tcp = asio::ip::tcp;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;

namespace {

constexpr std::size_t kReadBytes = std::size_t{64} << 10U;  // at a time, of a body
constexpr int kSendBufferBytes = 256 << 10;
constexpr std::chrono::milliseconds kLingerDraining{
    200};  // a stop does not wait for silent clients
constexpr std::chrono::seconds kPipelinedLook{1};

std::string View(beast::string_view text) { return std::string(text.data(), text.size()); }

// The first line ends with a version, just not with one of ours.
bool NamesAVersion(const beast::flat_buffer& buffer) {
  const std::string_view text(static_cast<const char*>(buffer.data().data()), buffer.size());
  const std::string_view line = text.substr(0, text.find("\r\n"));
  const std::size_t at = line.rfind(" HTTP/");
  return at != std::string_view::npos && line.size() == at + 9 && line[at + 7] == '.';
}

HttpResponse Refusal(int http_status, ErrorCode code, std::string detail) {
  return JsonRefusal({.status = FromError({code, std::move(detail), {}}),
                      .http_status = http_status,
                      .headers = {}},
                     false);
}

}  // namespace

class HttpSession : public Connection,
                    public OpenSession,
                    public std::enable_shared_from_this<HttpSession> {
 public:
  HttpSession(const SessionSetting& setting, tcp::socket socket)
      : OpenSession(setting.table),
        setting_(setting),
        options_(setting.gateway.options),
        socket_(std::move(socket)),
        buffer_(options_.header_bytes_max + kReadBytes),
        deadline_(socket_.get_executor()),
        quiet_(socket_.get_executor()) {
    setting_.table.Add(this);
  }
  ~HttpSession() override { setting_.table.Remove(this); }
  HttpSession(const HttpSession&) = delete;
  HttpSession& operator=(const HttpSession&) = delete;

  void Run(bool refused) {
    error_code ignored;
    socket_.set_option(tcp::no_delay(true), ignored);
    socket_.set_option(asio::socket_base::keep_alive(true), ignored);
    // Bounds what a reader that does not read costs, and lets a slow one be seen to make progress:
    // the system tells of room only when a third of this is free.
    socket_.set_option(asio::socket_base::send_buffer_size(kSendBufferBytes), ignored);
    const tcp::endpoint peer = socket_.remote_endpoint(ignored);
    const std::string address = peer.address().to_string();
    peer_ = (peer.address().is_v6() ? "[" + address + "]" : address) + ":" +
            std::to_string(peer.port());
    if (refused) {
      closing_ = true;
      return Send(TooManyConnections());
    }
    AwaitRequest();
  }

  tcp::socket::executor_type Executor() { return socket_.get_executor(); }

  // From any thread, while the table's lock keeps this alive.
  void End(bool at_once) override {
    std::weak_ptr<HttpSession> weak = weak_from_this();
    asio::post(socket_.get_executor(), [weak, at_once] {
      if (const auto self = weak.lock()) self->EndNow(at_once);
    });
  }

  void Send(HttpResponse response) override {
    const bool bodiless = response.status == 204 || response.status == 304;
    const std::size_t length = response.length.value_or(response.body.size());
    std::string body = std::move(response.body);
    if (bodiless || request_.method == "HEAD") body.clear();
    // A body that was not read would be taken for the next request.
    if (!body_read_) closing_ = true;
    ended_ = true;
    WriteOut(HeadText(response, bodiless ? Framing::kNone : Framing::kLength, length),
             std::move(body), {});
    exchange_.reset();
  }

  void Begin(HttpResponse head) override {
    framing_ = head.length              ? Framing::kLength
               : request_.version >= 11 ? Framing::kChunked
                                        : Framing::kClose;
    if (framing_ == Framing::kClose) closing_ = true;
    if (!body_read_) closing_ = true;
    WriteOut(HeadText(head, framing_, head.length.value_or(0)), {}, {});
  }

  void Write(std::string bytes) override {
    if (framing_ == Framing::kChunked) {
      std::string head = ChunkHead(bytes.size());
      return WriteOut(std::move(head), std::move(bytes), "\r\n");
    }
    WriteOut({}, std::move(bytes), {});
  }

  void Finish() override {
    ended_ = true;
    exchange_.reset();
    if (framing_ == Framing::kChunked) return WriteOut("0\r\n\r\n", {}, {});
    AfterAnswer();
  }

  void Abort() override {
    exchange_.reset();
    broken_ = true;
    Log();
    Close();
  }

  void ReadBody() override { ReadPiece(); }

  void Post(std::function<void()> work) override {
    // The work may hold the last reference to an exchange, so the session is held beside it.
    asio::post(socket_.get_executor(),
               [self = shared_from_this(), work = std::move(work)] { work(); });
  }

 private:
  using Parser = http::request_parser<http::buffer_body>;

  auto Bound(void (HttpSession::*method)(error_code)) {
    return [self = shared_from_this(), method](error_code error, auto&&...) {
      ((*self).*method)(error);
    };
  }

  // --- reading
  // ---------------------------------------------------------------------------------------

  void AwaitRequest() {
    request_ = {};
    request_.peer = peer_;
    body_read_ = true;
    ended_ = broken_ = pipelined_ = false;
    status_sent_ = 0;
    bytes_sent_ = 0;
    if (closing_ || setting_.draining) return Close();
    reading_ = Reading::kIdle;
    if (buffer_.size() > 0 || first_request_) return ReadHeader();
    Arm(options_.idle_timeout);
    socket_.async_wait(tcp::socket::wait_read, Bound(&HttpSession::OnReadable));
  }

  void OnReadable(error_code error) {
    if (error || timed_out_) return Close();
    ReadHeader();
  }

  void ReadHeader() {
    first_request_ = false;
    reading_ = Reading::kHeader;
    parser_.emplace();
    parser_->header_limit(static_cast<std::uint32_t>(options_.header_bytes_max));
    // The limit depends on the path and is kept in OnPiece. Beast 1.74 takes "none" for zero.
    parser_->body_limit(std::numeric_limits<std::uint64_t>::max());
    Arm(options_.read_timeout);
    http::async_read_header(socket_, buffer_, *parser_, Bound(&HttpSession::OnHeader));
  }

  void OnHeader(error_code error) {
    Disarm();
    begun_ = Clock::now();
    if (error) return OnReadFailed(error);
    if (setting_.draining) closing_ = true;
    const auto& message = parser_->get();
    request_.method = View(message.method_string());
    request_.version = static_cast<int>(message.version());
    for (const auto& field : message) {
      request_.headers.emplace_back(LowerCase(View(field.name_string())), View(field.value()));
    }
    request_.host = request_.Header("host");
    SetTarget(View(message.target()), request_);
    if (!parser_->keep_alive()) closing_ = true;
    body_read_ = parser_->is_done();
    reading_ = Reading::kNothing;

    plan_ = MakePlan(setting_.gateway, request_);
    if (plan_.answer) {
      if (plan_.answer->status == 400)
        closing_ = true;  // who sends such requests is not trusted further
      return Send(*std::exchange(plan_.answer, std::nullopt));
    }
    const std::string_view expect = request_.Header("expect");
    if (!expect.empty() && !EqualIgnoringCase(expect, "100-continue")) {
      return Send(Refusal(417, ErrorCode::kCellInvalidArgument,
                          "Expect is understood as 100-continue only"));
    }
    const auto length = parser_->content_length();
    if (length && *length > plan_.body_bytes_max) return RefuseTooLarge();
    if (body_read_ || plan_.stream_body) return StartExchange();
    ReadPiece();
  }

  void OnReadFailed(error_code error) {
    if (error == http::error::end_of_stream || closed_) return Close();
    closing_ = true;
    body_read_ = false;
    if (timed_out_) {
      if (reading_ == Reading::kHeader && buffer_.size() == 0)
        return Close();  // said nothing at all
      return Send(
          Refusal(408, ErrorCode::kCellInvalidArgument, "the request did not come in time"));
    }
    if (error == http::error::header_limit || error == http::error::buffer_overflow) {
      return Send(Refusal(431, ErrorCode::kCellTooLarge, "the headers are too long"));
    }
    if (error == http::error::bad_version && NamesAVersion(buffer_)) {
      return Send(Refusal(505, ErrorCode::kCellInvalidArgument,
                          "the web port speaks HTTP/1.0 and HTTP/1.1"));
    }
    if (error.category() != http::make_error_code(http::error::bad_method).category() ||
        error == http::error::partial_message) {
      return Close();  // the client is gone
    }
    Send(Refusal(400, ErrorCode::kCellInvalidArgument,
                 "this is no HTTP request: " + error.message()));
  }

  void RefuseTooLarge() {
    LeaveExchange();
    Send(Refusal(413, ErrorCode::kCellTooLarge,
                 "the body may have " + std::to_string(plan_.body_bytes_max) + " bytes"));
  }

  // One piece of up to kReadBytes; collected, or handed to the exchange.
  void ReadPiece() {
    if (body_read_) return HandOver();
    if (!continued_ && request_.version >= 11 && !request_.Header("expect").empty() &&
        buffer_.size() == 0) {
      continued_ = true;
      asio::async_write(socket_, asio::buffer(std::string_view("HTTP/1.1 100 Continue\r\n\r\n")),
                        Bound(&HttpSession::OnContinued));
      return;
    }
    if (piece_.empty()) piece_.resize(kReadBytes);
    parser_->get().body().data = piece_.data();
    parser_->get().body().size = piece_.size();
    reading_ = Reading::kBody;
    // Of a call the whole body has this time, of an upload each piece.
    if (plan_.stream_body || body_total_ == 0) Arm(options_.read_timeout);
    http::async_read(socket_, buffer_, *parser_, Bound(&HttpSession::OnPiece));
  }

  void OnContinued(error_code error) {
    if (error) return Gone();
    ReadPiece();
  }

  void OnPiece(error_code error) {
    if (closed_) return;
    if (error && error != http::error::need_buffer) {
      if (exchange_) LeaveExchange();
      return OnReadFailed(error);
    }
    piece_size_ = piece_.size() - parser_->get().body().size;
    body_total_ += piece_size_;
    if (body_total_ > plan_.body_bytes_max) return RefuseTooLarge();
    body_read_ = parser_->is_done();
    if (body_read_ || plan_.stream_body) Disarm();
    HandOver();
  }

  void HandOver() {
    const std::string_view piece(piece_.data(), std::exchange(piece_size_, 0));
    reading_ = Reading::kNothing;
    if (plan_.stream_body) {
      if (body_read_) Watch();
      const auto exchange = exchange_;
      if (exchange) exchange->OnBody(piece, body_read_);
      return;
    }
    request_.body += piece;
    if (!body_read_) return ReadPiece();
    StartExchange();
  }

  void StartExchange() {
    exchange_ = plan_.exchange(shared_from_this(), request_);
    if (body_read_) Watch();
    AwaitQuiet();
    const auto exchange = exchange_;
    exchange->Start();
  }

  // --- writing
  // ---------------------------------------------------------------------------------------

  std::string HeadText(HttpResponse& response, Framing framing, std::size_t length) {
    AddCorsHeaders(setting_.gateway.rules, request_, response);
    response.headers.emplace_back("Date", HttpDate());
    status_sent_ = response.status;
    return SerializeHead(response, framing, length, !closing_ && !setting_.draining);
  }

  // Kept until they are written.
  void WriteOut(std::string head, std::string body, std::string_view tail) {
    head_ = std::move(head);
    body_ = std::move(body);
    const std::array<asio::const_buffer, 3> pieces = {asio::buffer(head_), asio::buffer(body_),
                                                      asio::buffer(tail)};
    // Each step forward gives it new time: slow is allowed, stuck is not.
    Arm(options_.write_timeout);
    auto progress = [self = shared_from_this()](error_code error, std::size_t) -> std::size_t {
      if (error) return 0;
      self->Arm(self->options_.write_timeout);
      return kReadBytes;
    };
    asio::async_write(socket_, pieces, progress,
                      [self = shared_from_this()](error_code error, std::size_t size) {
                        self->bytes_sent_ += size;
                        self->OnWritten(error);
                      });
  }

  void OnWritten(error_code error) {
    Disarm();
    head_.clear();
    std::string().swap(body_);  // a long message is not kept while nothing is sent
    if (closed_) return;
    if (error) return Gone();
    if (ended_) return AfterAnswer();
    AwaitQuiet();
    const auto exchange = exchange_;
    if (exchange) exchange->OnTaken();
  }

  void AfterAnswer() {
    quiet_.cancel();
    Log();
    plan_ = {};
    body_total_ = 0;
    continued_ = false;
    std::string().swap(piece_);
    if (closing_ || setting_.draining) return Linger();
    AwaitRequest();
  }

  // The answer is read only when the client has sent all it wants to send: bytes that come in after
  // a close would make the system throw the answer away.
  void Linger() {
    error_code ignored;
    socket_.shutdown(tcp::socket::shutdown_send, ignored);
    reading_ = Reading::kLinger;
    Arm(setting_.draining ? kLingerDraining : options_.linger_timeout);
    piece_.resize(kReadBytes);
    ReadAndForget();
  }

  void ReadAndForget() {
    socket_.async_read_some(asio::buffer(piece_),
                            [self = shared_from_this()](error_code error, std::size_t) {
                              if (error || self->timed_out_) return self->Close();
                              self->ReadAndForget();
                            });
  }

  // --- the client leaves, time passes, the server stops
  // ---------------------------------------------

  // While an answer is being made nothing is read, or the next request would be swallowed; one byte
  // is only looked at.
  void Watch() {
    if (watching_) return;
    watching_ = true;
    socket_.async_wait(tcp::socket::wait_read, Bound(&HttpSession::OnWatch));
  }

  void OnWatch(error_code error) {
    watching_ = false;
    if (error || closed_ || !exchange_ || !body_read_) return;
    char byte = 0;
    const ssize_t size = recv(socket_.native_handle(), &byte, 1, MSG_PEEK | MSG_DONTWAIT);
    if (size == 0) {
      // It has said all it wants to say; who waits for a stream that has no end does not
      // half-close.
      if (exchange_->IsEndless()) return Gone();
      closing_ = true;
      Arm(options_.linger_timeout);  // it may have left altogether, which looks the same
      return;
    }
    if (size < 0) return errno == EAGAIN ? Watch() : Gone();
    // The next request is there already, and hides the end of the connection behind it.
    pipelined_ = true;
    AwaitQuiet();
  }

  // Cancelled by the next write, so it fires when nothing was written.
  void AwaitQuiet() {
    if (!exchange_) return;
    const auto interval = pipelined_
                              ? std::min<Clock::duration>(kPipelinedLook, options_.quiet_interval)
                              : Clock::duration(options_.quiet_interval);
    quiet_.expires_after(interval);
    quiet_.async_wait(Bound(&HttpSession::OnQuiet));
  }

  void OnQuiet(error_code error) {
    const auto exchange = exchange_;
    if (error || closed_ || !exchange) return;
    if (pipelined_) {
      tcp_info info{};
      socklen_t size = sizeof(info);
      const int got = getsockopt(socket_.native_handle(), IPPROTO_TCP, TCP_INFO, &info, &size);
      if (got == 0 && info.tcpi_state != TCP_ESTABLISHED) return Gone();
    }
    exchange->OnQuiet();
    AwaitQuiet();
  }

  void LeaveExchange() {
    if (const auto exchange = std::exchange(exchange_, nullptr)) exchange->OnGone();
  }

  void Gone() {
    if (closed_) return;
    broken_ = true;
    LeaveExchange();
    Log();
    Close();
  }

  void EndNow(bool at_once) {
    if (closed_) return;
    if (at_once) return Gone();
    closing_ = true;
    if (reading_ == Reading::kIdle || (reading_ == Reading::kHeader && buffer_.size() == 0))
      Close();
  }

  void Arm(std::chrono::milliseconds patience) {
    timed_out_ = false;
    deadline_.expires_after(patience);
    deadline_.async_wait([weak = weak_from_this()](error_code error) {
      const auto self = weak.lock();
      if (!error && self) self->OnDeadline();
    });
  }

  // Also for a handler that is about to run: it finds that nothing has passed.
  void Disarm() { deadline_.expires_at(Clock::time_point::max()); }

  void OnDeadline() {
    if (closed_ || deadline_.expiry() > Clock::now()) return;  // it was set anew in the meantime
    timed_out_ = true;
    error_code ignored;
    if (reading_ == Reading::kNothing) return Gone();  // a write is stuck
    socket_.cancel(ignored);                           // the reader sees timed_out_
  }

  void Log() {
    if (!setting_.logger || request_.method.empty()) return;
    const auto duration =
        std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - begun_);
    setting_.logger({.peer = peer_,
                     .method = request_.method,
                     .path = request_.path,
                     .request_id = std::string(request_.Header("x-request-id")),
                     .http_status = status_sent_,
                     .bytes_sent = bytes_sent_,
                     .duration = duration,
                     .finished = !broken_});
    request_.method.clear();  // once
  }

  void Close() {
    if (std::exchange(closed_, true)) return;
    error_code ignored;
    deadline_.cancel();
    quiet_.cancel();
    socket_.close(ignored);
  }

  enum class Reading { kNothing, kIdle, kHeader, kBody, kLinger };

  const SessionSetting setting_;
  const WebOptions& options_;
  tcp::socket socket_;
  beast::flat_buffer buffer_;  // what came in and was not used yet, the next request included
  std::optional<Parser> parser_;
  asio::steady_timer deadline_;
  asio::steady_timer quiet_;
  std::string peer_;

  HttpRequest request_;
  Plan plan_;
  std::shared_ptr<Exchange> exchange_;  // empty between requests
  Framing framing_ = Framing::kLength;
  std::string piece_;  // of a body
  std::size_t piece_size_ = 0;
  std::size_t body_total_ = 0;
  std::string head_;  // being written
  std::string body_;  // being written
  Clock::time_point begun_ = Clock::now();
  int status_sent_ = 0;
  std::size_t bytes_sent_ = 0;

  Reading reading_ = Reading::kNothing;
  bool first_request_ = true;
  bool continued_ = false;
  bool body_read_ = true;  // nothing of this request is left unread
  bool ended_ = false;     // the last write of an answer is under way
  bool closing_ = false;   // after this answer
  bool broken_ = false;    // the answer was not finished
  bool watching_ = false;
  bool pipelined_ = false;
  bool timed_out_ = false;
  bool closed_ = false;
};

void StartSession(const SessionSetting& setting, tcp::socket socket, bool refused) {
  const auto session = std::make_shared<HttpSession>(setting, std::move(socket));
  asio::dispatch(session->Executor(), [session, refused] { session->Run(refused); });
}

}  // namespace rmlcell::web
