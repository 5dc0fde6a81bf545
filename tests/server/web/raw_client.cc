#include "tests/server/web/raw_client.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdlib>

#include "engine/core/letters.h"
#include "server/web/http_message.h"

namespace rmlcell::web::testing {

RawClient::RawClient() : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  timeval patience{.tv_sec = 60, .tv_usec = 0};
  setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
}

RawClient::RawClient(int port, int receive_buffer_bytes) : RawClient() {
  if (receive_buffer_bytes > 0) {
    setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receive_buffer_bytes, sizeof(receive_buffer_bytes));
  }
  Connect(port);
}

void RawClient::Connect(int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) != 0) Close();
}

RawClient::~RawClient() { Close(); }

bool RawClient::Send(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
  return true;
}

void RawClient::HalfClose() { shutdown(socket_, SHUT_WR); }

void RawClient::Reset() {
  const linger now{.l_onoff = 1, .l_linger = 0};
  setsockopt(socket_, SOL_SOCKET, SO_LINGER, &now, sizeof(now));
  Close();
}

void RawClient::Close() {
  if (socket_ >= 0) close(socket_);
  socket_ = -1;
}

bool RawClient::Fill() {
  std::array<char, 16384> bytes{};
  const ssize_t size = recv(socket_, bytes.data(), bytes.size(), 0);
  if (size <= 0) return false;
  buffer_.append(bytes.data(), static_cast<std::size_t>(size));
  return true;
}

std::string RawClient::ReadUntil(std::string_view mark) {
  std::size_t at = buffer_.find(mark);
  while (at == std::string::npos) {
    const std::size_t seen = buffer_.size() < mark.size() ? 0 : buffer_.size() - mark.size();
    if (!Fill()) return std::exchange(buffer_, {});
    at = buffer_.find(mark, seen);
  }
  const std::string text = buffer_.substr(0, at + mark.size());
  buffer_.erase(0, at + mark.size());
  return text;
}

std::optional<std::string> RawClient::Take(std::size_t size) {
  while (buffer_.size() < size) {
    if (!Fill()) return std::nullopt;
  }
  std::string bytes = buffer_.substr(0, size);
  buffer_.erase(0, size);
  return bytes;
}

RawResponse RawClient::ReadHead() {
  RawResponse response;
  const std::string head = ReadUntil("\r\n\r\n");
  if (!head.starts_with("HTTP/1.1 ") || !head.ends_with("\r\n\r\n")) return response;
  response.status = std::atoi(head.c_str() + 9);
  for (std::size_t line = head.find("\r\n") + 2; line + 2 < head.size();) {
    const std::size_t end = head.find("\r\n", line);
    const std::string text = head.substr(line, end - line);
    const std::size_t colon = text.find(": ");
    response.headers[LowerCase(text.substr(0, colon))] = text.substr(colon + 2);
    line = end + 2;
  }
  return response;
}

RawResponse RawClient::Read(bool head) {
  RawResponse response = ReadHead();
  if (response.status == 0) return response;
  if (head || response.status == 204 || response.status == 304) {
    response.complete = true;
  } else if (response.Header("transfer-encoding") == "chunked") {
    while (true) {
      const std::string line = ReadUntil("\r\n");
      if (!line.ends_with("\r\n")) return response;
      const std::size_t size = std::strtoul(line.c_str(), nullptr, 16);
      const auto chunk = Take(size + 2);
      if (!chunk || !chunk->ends_with("\r\n")) return response;
      if (size == 0) break;
      response.body += chunk->substr(0, size);
    }
    response.complete = true;
  } else if (response.headers.contains("content-length")) {
    const std::size_t length = std::strtoul(response.Header("content-length").c_str(), nullptr, 10);
    auto body = Take(length);
    response.complete = body.has_value();
    response.body = body ? *std::move(body) : std::exchange(buffer_, {});
  } else {
    while (Fill()) {
    }
    response.body = std::exchange(buffer_, {});
    response.complete = true;
  }
  return response;
}

bool RawClient::AtEnd() {
  if (!buffer_.empty()) return false;
  char byte = 0;
  const ssize_t size = recv(socket_, &byte, 1, MSG_PEEK);
  return size == 0 || (size < 0 && errno == ECONNRESET);
}

bool RawClient::AnswersWithin(std::chrono::milliseconds time) {
  pollfd one{.fd = socket_, .events = POLLIN, .revents = 0};
  return !buffer_.empty() || poll(&one, 1, static_cast<int>(time.count())) != 0;
}

std::string Post(std::string_view path, std::string_view content_type, std::string_view body,
                 std::string_view headers) {
  std::string request = "POST " + std::string(path) + " HTTP/1.1\r\nHost: localhost\r\n";
  if (!content_type.empty()) request += "Content-Type: " + std::string(content_type) + "\r\n";
  request +=
      "Content-Length: " + std::to_string(body.size()) + "\r\n" + std::string(headers) + "\r\n";
  return request + std::string(body);
}

std::string Get(std::string_view target, std::string_view headers) {
  return "GET " + std::string(target) + " HTTP/1.1\r\nHost: localhost\r\n" + std::string(headers) +
         "\r\n";
}

RawResponse Exchange(int port, std::string_view request) {
  RawClient client(port);
  client.Send(request);
  return client.Read(request.starts_with("HEAD "));
}

}  // namespace rmlcell::web::testing
