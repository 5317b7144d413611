// SPDX-License-Identifier: MIT
#include "firmware/host_tool/console/web_http.hpp"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

namespace armsig::tool {
namespace {

constexpr std::string_view kEndOfHead = "\r\n\r\n";

std::string_view reason(int status) {
  switch (status) {
    case 200:
      return "OK";
    case 202:
      return "Accepted";
    case 403:
      return "Forbidden";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 409:
      return "Conflict";
    case 413:
      return "Content Too Large";
    case 431:
      return "Request Header Fields Too Large";
    case 503:
      return "Service Unavailable";
    case 505:
      return "HTTP Version Not Supported";
    default:
      return "Bad Request";
  }
}

std::string_view trimmed_blanks(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

bool is_named(std::string_view field, std::string_view name) {
  const auto lower = [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  };
  return std::ranges::equal(field, name, {}, lower);
}

// What is printable: neither a control character nor a byte that a proxy may read otherwise.
bool is_plain(std::string_view text) {
  return std::ranges::all_of(text, [](char c) { return (c >= ' ' && c <= '~') || c == '\t'; });
}

bool read_request_line(std::string_view line, HttpRequest& request) {
  const std::size_t first = line.find(' ');
  const std::size_t last = line.rfind(' ');
  if (first == 0 || first == std::string_view::npos || first == last) return false;
  request.method = line.substr(0, first);
  const std::string_view target = line.substr(first + 1, last - first - 1);
  const std::string_view version = line.substr(last + 1);
  if (version != "HTTP/1.1" && version != "HTTP/1.0") {
    request.refused = version.starts_with("HTTP/") ? 505 : 400;
    return true;
  }
  request.keeps_alive = version == "HTTP/1.1";
  const std::size_t question = std::min(target.find('?'), target.size());
  request.path = target.substr(0, question);
  request.query = target.substr(std::min(question + 1, target.size()));
  return target.starts_with('/') && target.find(' ') == std::string_view::npos;
}

// A field that decides is taken once; twice, and two readers may take different ones.
bool read_field(std::string_view line, HttpRequest& request, bool& has_length) {
  const std::size_t colon = line.find(':');
  if (colon == 0 || colon == std::string_view::npos) return false;
  const std::string_view name = line.substr(0, colon);
  if (name.find_first_of(" \t") != std::string_view::npos) return false;
  const std::string_view value = trimmed_blanks(line.substr(colon + 1));
  const auto once = [&](std::string_view& into) {
    const bool first = into.empty();
    into = value;
    return first;
  };
  if (is_named(name, "host")) return once(request.host);
  if (is_named(name, "origin")) return once(request.origin);
  if (is_named(name, "content-type")) return once(request.content_type);
  if (is_named(name, "connection")) {
    if (is_named(value, "close")) request.keeps_alive = false;
    return true;
  }
  if (is_named(name, "transfer-encoding") || is_named(name, "upgrade")) return false;
  if (!is_named(name, "content-length")) return true;
  if (has_length) return false;
  has_length = true;
  const auto [end, error] =
      std::from_chars(value.data(), value.data() + value.size(), request.body_bytes);
  return !value.empty() && value[0] != '-' && error == std::errc{} &&
         end == value.data() + value.size();
}

}  // namespace

std::optional<HttpRequest> http_request(std::string_view bytes) {
  HttpRequest request;
  const std::size_t end = bytes.substr(0, kLongestHead).find(kEndOfHead);
  if (end == std::string_view::npos) {
    if (bytes.size() < kLongestHead) return std::nullopt;
    request.refused = 431;
    return request;
  }
  request.head_bytes = end + kEndOfHead.size();
  bool good = true;
  bool has_length = false;
  bool first = true;
  for (std::string_view rest = bytes.substr(0, end); good && (first || !rest.empty());) {
    const std::size_t stop = std::min(rest.find("\r\n"), rest.size());
    const std::string_view line = rest.substr(0, stop);
    good = is_plain(line) &&
           (first ? read_request_line(line, request) : read_field(line, request, has_length));
    first = false;
    rest.remove_prefix(std::min(stop + 2, rest.size()));
  }
  if (!good) request.refused = 400;
  if (request.refused == 0 && request.body_bytes > kLongestBody) request.refused = 413;
  return request;
}

std::string_view query_value(std::string_view query, std::string_view name) {
  while (!query.empty()) {
    const std::size_t stop = std::min(query.find('&'), query.size());
    const std::string_view pair = query.substr(0, stop);
    if (pair.size() > name.size() && pair.starts_with(name) && pair[name.size()] == '=') {
      return pair.substr(name.size() + 1);
    }
    query.remove_prefix(std::min(stop + 1, query.size()));
  }
  return {};
}

std::string http_head(const HttpReply& reply, std::optional<std::size_t> length, bool closes) {
  std::string head = fmt::format("HTTP/1.1 {} {}\r\nContent-Type: {}\r\n", reply.status,
                                 reason(reply.status), reply.type);
  if (length) head += fmt::format("Content-Length: {}\r\n", *length);
  if (closes) head += "Connection: close\r\n";
  head +=
      "Content-Security-Policy: default-src 'none'; script-src 'self'; style-src 'self'; "
      "connect-src 'self'; img-src 'self' data:; base-uri 'none'; form-action 'none'; "
      "frame-ancestors 'none'\r\n"
      "X-Content-Type-Options: nosniff\r\n"
      "Referrer-Policy: no-referrer\r\n"
      "Cross-Origin-Resource-Policy: same-origin\r\n"
      "Cross-Origin-Opener-Policy: same-origin\r\n"
      "Cache-Control: no-store\r\n";
  return head + reply.fields + "\r\n";
}

std::string http_text(const HttpReply& reply, bool closes) {
  return http_head(reply, reply.body.size(), closes) + reply.body;
}

}  // namespace armsig::tool
