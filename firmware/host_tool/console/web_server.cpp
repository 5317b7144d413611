// SPDX-License-Identifier: MIT
#include "firmware/host_tool/console/web_server.hpp"

#include <httplib.h>
#include <sys/stat.h>

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <thread>
#include <vector>

#include <fmt/core.h>

#include "firmware/host_tool/console/web_advice.hpp"
#include "firmware/host_tool/console/web_files.hpp"

namespace armsig::tool {
namespace {

using std::chrono::milliseconds;

// A stream takes a worker as long as it lasts; the others serve what is asked once.
constexpr std::size_t kWorkers = WebViewers::kMost + 6;
constexpr std::size_t kMostWaiting = 16;      // connections that no worker has taken up
constexpr milliseconds kLongestSilence{500};  // of a stream: by then its viewer hears of us
constexpr int kMostUnread = 32768;            // bytes
constexpr std::size_t kLongestBody = 512;
constexpr std::size_t kLongestViewer = 64;
constexpr std::uintmax_t kLargestBlackBox = std::uintmax_t{64} << 20U;
constexpr int kForbidden = 403;

// A fixed number of threads, and a queue that makes accept() wait when it is full: further
// connections are the kernel's, which refuses what is too much for it.
class Workers final : public httplib::TaskQueue {
 public:
  Workers() {
    for (std::size_t i = 0; i < kWorkers; ++i) threads_.emplace_back([this] { work(); });
  }

  void enqueue(std::function<void()> task) override {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return tasks_.size() < kMostWaiting || ending_; });
    tasks_.push_back(std::move(task));
    changed_.notify_all();
  }

  void shutdown() override {
    {
      const std::lock_guard lock(mutex_);
      ending_ = true;
    }
    changed_.notify_all();
    for (std::thread& thread : threads_) thread.join();
  }

 private:
  void work() {
    for (;;) {
      std::function<void()> task;
      {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return !tasks_.empty() || ending_; });
        if (tasks_.empty()) return;
        task = std::move(tasks_.front());
        tasks_.pop_front();
        changed_.notify_all();
      }
      task();
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> tasks_;
  std::vector<std::thread> threads_;
  bool ending_ = false;
};

// In a time that does not tell how much of it is right.
bool is_same(std::string_view one, std::string_view other) {
  if (one.size() != other.size()) return false;
  unsigned different = 0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    different |= static_cast<unsigned char>(one[i]) ^ static_cast<unsigned char>(other[i]);
  }
  return different == 0;
}

bool is_viewer(std::string_view name) {
  const auto is_letter = [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z'); };
  return !name.empty() && name.size() <= kLongestViewer && std::ranges::all_of(name, is_letter);
}

void refuse(httplib::Response& response, int status, const std::string& words) {
  response.status = status;
  response.set_content(words + "\n", "text/plain; charset=utf-8");
}

// What the controller says is its file must look like one of its black box.
bool is_black_box(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  std::error_code error;
  return name.starts_with("black-box-") && name.ends_with(".csv") &&
         std::filesystem::is_regular_file(path, error) &&
         std::filesystem::file_size(path, error) <= kLargestBlackBox;
}

void send_black_box(const std::string& file, httplib::Response& response) {
  if (file.empty()) return refuse(response, 404, "no fault has left a black box yet");
  const std::filesystem::path path(file);
  std::ifstream in(path, std::ios::binary);
  if (!is_black_box(path) || !in) {
    return refuse(response, 404, "the black box is a file of the controller's computer: " + file);
  }
  response.set_header("Content-Disposition",
                      fmt::format("attachment; filename=\"{}\"", path.filename().string()));
  response.set_content(std::string(std::istreambuf_iterator<char>(in), {}), "text/csv");
}

void harden(httplib::Server& server) {
  server.new_task_queue = [] { return new Workers; };
  server.set_read_timeout(2);
  server.set_write_timeout(2);  // a reader that is slower than that is dropped
  server.set_keep_alive_timeout(2);
  server.set_keep_alive_max_count(32);
  server.set_payload_max_length(kLongestBody);
  server.set_tcp_nodelay(true);
  server.set_default_headers(
      {{"Content-Security-Policy",
        "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
        "img-src 'self' data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
       {"X-Content-Type-Options", "nosniff"},
       {"Referrer-Policy", "no-referrer"},
       {"Cross-Origin-Resource-Policy", "same-origin"},
       {"Cross-Origin-Opener-Policy", "same-origin"},
       {"Cache-Control", "no-store"}});
}

}  // namespace

struct WebServer::Http {
  httplib::Server server;
  std::string advice = web_advice().dump();
};

WebServer::WebServer(std::string token, WebBoard& board, WebWatch& watch)
    : token_(std::move(token)), board_(board), watch_(watch), http_(std::make_unique<Http>()) {
  harden(http_->server);
  http_->server.set_pre_routing_handler([this](const auto& request, auto& response) {
    return admits(request, response) ? httplib::Server::HandlerResponse::Unhandled
                                     : httplib::Server::HandlerResponse::Handled;
  });
  http_->server.Get(".*", [this](const auto& request, auto& response) { get(request, response); });
  http_->server.Post(".*",
                     [this](const auto& request, auto& response) { post(request, response); });
}

WebServer::~WebServer() { http_->server.stop(); }

std::optional<int> WebServer::bind(int port) {
  constexpr const char* kLoopback = "127.0.0.1";
  httplib::Server& server = http_->server;
  // Not the library's SO_REUSEPORT, with which a second server would share the port in silence.
  server.set_socket_options([](socket_t socket) {
    const int yes = 1;
    ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    // What a reader has not taken of a few seconds; more, and it is dropped.
    ::setsockopt(socket, SOL_SOCKET, SO_SNDBUF, &kMostUnread, sizeof kMostUnread);
  });
  if (port == 0) {
    port_ = server.bind_to_any_port(kLoopback);
  } else {
    port_ = server.bind_to_port(kLoopback, port) ? port : -1;
  }
  if (port_ <= 0) return std::nullopt;
  return port_;
}

bool WebServer::serve() { return http_->server.listen_after_bind(); }

std::string WebServer::address() const {
  return fmt::format("http://127.0.0.1:{}/{}/", port_, token_);
}

// A page elsewhere can make a browser ask us, by a name that it lets mean 127.0.0.1: but then the
// Host is that name, and the Origin that page.
bool WebServer::admits(const httplib::Request& request, httplib::Response& response) const {
  const std::string host = request.get_header_value("Host");
  const bool ours =
      host == fmt::format("127.0.0.1:{}", port_) || host == fmt::format("localhost:{}", port_);
  const std::string origin = request.get_header_value("Origin");
  const std::string_view path = request.path;
  const std::size_t end = path.find('/', 1);
  if (!ours || (!origin.empty() && origin != "http://" + host) || end == std::string_view::npos ||
      !is_same(path.substr(1, end - 1), token_)) {
    refuse(response, kForbidden, "the address that `armsig connect --web` printed is needed whole");
    return false;
  }
  if (request.method != "GET" && request.method != "POST") {
    refuse(response, 405, "only GET and POST");
    return false;
  }
  return true;
}

void WebServer::get(const httplib::Request& request, httplib::Response& response) {
  const std::string_view name = std::string_view(request.path).substr(token_.size() + 2);
  if (name == "events") return stream(request, response);
  if (name == "black-box.csv") return send_black_box(board_.black_box(), response);
  if (name == "advice.json") return response.set_content(http_->advice, "application/json");
  const std::string_view wanted = name.empty() ? "page.html" : name;
  const auto* const file = std::ranges::find(kWebFiles, wanted, &WebFile::name);
  if (file == kWebFiles.end()) return refuse(response, 404, "there is no such thing");
  response.set_content(file->content.data(), file->content.size(), std::string(file->type));
}

void WebServer::stream(const httplib::Request& request, httplib::Response& response) {
  const std::string viewer = request.get_param_value("viewer");
  if (!is_viewer(viewer)) return refuse(response, 400, "viewer=: letters and digits");
  const auto place = viewers_.begin(viewer);
  if (!place) return refuse(response, 503, "too many look already");
  board_.touch();
  auto seen = std::make_shared<WebBoard::Seen>();
  response.set_chunked_content_provider(
      "text/event-stream",
      [this, viewer, seen](std::size_t /*offset*/, httplib::DataSink& sink) {
        if (!board_.wait(*seen, kLongestSilence)) return false;
        const std::string events = board_.events(*seen, viewers_.told(viewer));
        return sink.write(events.data(), events.size());
      },
      [this, place](bool /*success*/) {
        viewers_.end(*place);
        board_.touch();
      });
}

void WebServer::post(const httplib::Request& request, httplib::Response& response) {
  const auto json = nlohmann::json::parse(request.body, nullptr, false);
  const auto text = [&](const char* key) {
    const bool there = json.is_object() && json.contains(key) && json[key].is_string();
    return there ? json[key].get<std::string>() : std::string();
  };
  const std::string viewer = text("viewer");
  const std::string verb = text("verb");
  const bool known = verb == "take-over" || WebWatch::knows(verb);
  const bool sent_by_page = request.path == fmt::format("/{}/request", token_) &&
                            request.get_header_value("Content-Type") == "application/json";
  if (!sent_by_page || !is_viewer(viewer) || !known) {
    return refuse(response, 400, "not a request of the page");
  }
  if (verb == "take-over") {
    viewers_.take_over(viewer);
    board_.touch();
  } else if (verb != "stop" && !viewers_.holds(viewer)) {
    const bool free = viewers_.told(viewer)["free"];
    return refuse(response, kForbidden,
                  free ? "nobody holds the controls; take them over first"
                       : "another viewer holds the controls");
  } else if (!watch_.request(verb)) {
    return refuse(response, 409, "another request is under way");
  }
  response.status = 202;
}

std::string random_token() {
  std::random_device device;  // the kernel's
  std::string token;
  for (int i = 0; i < 4; ++i) token += fmt::format("{:08x}", device());
  return token;
}

}  // namespace armsig::tool
