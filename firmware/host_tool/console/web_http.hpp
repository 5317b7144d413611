// SPDX-License-Identifier: MIT
// What the live page's server needs of HTTP/1.1 (RFC 9112): whole requests of a bounded size, and
// replies.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace armsig::tool {

inline constexpr std::size_t kLongestHead = 8192;  // request line and fields
inline constexpr std::size_t kLongestBody = 512;

struct HttpRequest {
  std::string_view method;
  std::string_view path;                        // without what follows "?"
  std::string_view query;                       // that, as it is
  std::string_view host, origin, content_type;  // empty: not given
  std::size_t head_bytes = 0;
  std::size_t body_bytes = 0;
  bool keeps_alive = true;
  // What is wrong with it, as a status code: 400, 413, 431 or 505; 0: nothing.
  int refused = 0;
};

// The head of the request that `bytes` begin with, as views of them; nothing while it is not whole.
// A body must say its length, once: what else it could mean depends on who reads it.
[[nodiscard]] std::optional<HttpRequest> http_request(std::string_view bytes);

// The value of `name` in `query`, as it is; empty: none.
[[nodiscard]] std::string_view query_value(std::string_view query, std::string_view name);

struct HttpReply {
  int status = 200;
  std::string_view type = "text/plain; charset=utf-8";
  std::string body;
  std::string fields;  // further ones, each with its end of line
};

// All of it, or the head alone where `length` says how long what follows is; without a length the
// end of the connection is that of the reply.
[[nodiscard]] std::string http_text(const HttpReply& reply, bool closes);
[[nodiscard]] std::string http_head(const HttpReply& reply, std::optional<std::size_t> length,
                                    bool closes);

}  // namespace armsig::tool
