// SPDX-License-Identifier: MIT
#include "firmware/fleet/wire/mqtt_connection.hpp"

#include <mosquitto.h>
#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <mutex>
#include <utility>

namespace armsig::fleet {
namespace {

constexpr int kKeepalive_s = 30;
constexpr int kPacketsAtOnce = 200;
constexpr int kVerifyPeer = 1;  // SSL_VERIFY_PEER
constexpr int kFlushTries = 10;
constexpr int kFlushWait_ms = 20;

enum class Input : std::uint8_t { kNone, kMore, kEnded };

Input input_of(int socket) {
  char first = 0;
  const ssize_t count = ::recv(socket, &first, 1, MSG_PEEK | MSG_DONTWAIT);
  if (count > 0) return Input::kMore;
  return count < 0 && (errno == EAGAIN || errno == EINTR) ? Input::kNone : Input::kEnded;
}

void begin_library() {
  static std::once_flag once;
  std::call_once(once, [] { mosquitto_lib_init(); });
}

}  // namespace

void MqttConnection::Free::operator()(mosquitto* client) const { mosquitto_destroy(client); }

MqttConnection::MqttConnection(BrokerSettings settings, std::string client)
    : settings_(std::move(settings)), client_id_(std::move(client)) {
  begin_library();
}

MqttConnection::~MqttConnection() = default;

void MqttConnection::fail(Event::Kind kind) {
  client_.reset();
  events_.emplace_back().kind = kind;
}

// The callbacks only note what happened: they may be called from within any call of the library.
void MqttConnection::add_callbacks() {
  mosquitto_connect_callback_set(client_.get(), [](mosquitto*, void* self, int code) {
    static_cast<MqttConnection*>(self)->events_.emplace_back().kind =
        code == 0 ? Event::Kind::kConnected : Event::Kind::kRefused;
  });
  mosquitto_message_callback_set(
      client_.get(), [](mosquitto*, void* self, const mosquitto_message* message) {
        const auto* bytes = static_cast<const std::byte*>(message->payload);
        // None of ours is as long: it is not kept in memory until somebody looks at it.
        if (message->payloadlen > static_cast<int>(kLongestMessage)) return;
        Event& event = static_cast<MqttConnection*>(self)->events_.emplace_back();
        event.kind = Event::Kind::kMessage;
        event.topic = message->topic;
        event.qos = message->qos;
        event.retained = message->retain;
        if (message->payloadlen > 0) event.payload.assign(bytes, bytes + message->payloadlen);
      });
}

void MqttConnection::begin(const Message& will) {
  events_.clear();
  client_.reset(mosquitto_new(client_id_.c_str(), true, this));
  if (!client_) return fail(Event::Kind::kLost);
  add_callbacks();
  const std::string topic(will.topic);
  bool good =
      mosquitto_will_set(client_.get(), topic.c_str(), static_cast<int>(will.payload.size()),
                         will.payload.data(), will.qos, will.retain) == MOSQ_ERR_SUCCESS;
  if (good && !settings_.authority.empty()) {
    const auto file = [](const std::string& path) { return path.empty() ? nullptr : path.c_str(); };
    good =
        mosquitto_tls_set(client_.get(), settings_.authority.c_str(), nullptr,
                          file(settings_.certificate), file(settings_.key),
                          nullptr) == MOSQ_ERR_SUCCESS &&
        mosquitto_tls_opts_set(client_.get(), kVerifyPeer, "tlsv1.2", nullptr) == MOSQ_ERR_SUCCESS;
  }
  good = good && mosquitto_connect_async(client_.get(), settings_.address.c_str(), settings_.port,
                                         kKeepalive_s) == MOSQ_ERR_SUCCESS;
  if (!good) fail(Event::Kind::kLost);
}

void MqttConnection::subscribe(const std::string& topic, int qos) {
  if (client_) (void)mosquitto_subscribe(client_.get(), nullptr, topic.c_str(), qos);
}

bool MqttConnection::publish(const Message& message) {
  if (!client_ || (message.qos == 0 && mosquitto_want_write(client_.get()))) return false;
  const std::string topic(message.topic);
  return mosquitto_publish(client_.get(), nullptr, topic.c_str(),
                           static_cast<int>(message.payload.size()), message.payload.data(),
                           message.qos, message.retain) == MOSQ_ERR_SUCCESS;
}

void MqttConnection::end() {
  if (!client_) return;
  (void)mosquitto_disconnect(client_.get());
  for (int i = 0; i < kFlushTries && descriptor() >= 0 && wants_write(); ++i) {
    pollfd ready{.fd = descriptor(), .events = POLLOUT, .revents = 0};
    (void)::poll(&ready, 1, kFlushWait_ms);
    if (mosquitto_loop_write(client_.get(), kPacketsAtOnce) != MOSQ_ERR_SUCCESS) break;
  }
  client_.reset();
}

int MqttConnection::descriptor() const { return client_ ? mosquitto_socket(client_.get()) : -1; }

bool MqttConnection::wants_write() const { return client_ && mosquitto_want_write(client_.get()); }

// The library reads one packet of QoS 0 a call, whatever it is told: what has come is read here. It
// does not notice an end of the connection while TLS is being made.
void MqttConnection::service(bool readable, bool writable) {
  if (!client_) return;
  int result = MOSQ_ERR_SUCCESS;
  Input input = readable ? Input::kMore : Input::kNone;
  for (int i = 0; input == Input::kMore && i < kPacketsAtOnce && result == MOSQ_ERR_SUCCESS; ++i) {
    result = mosquitto_loop_read(client_.get(), 1);
    input = input_of(descriptor());
  }
  if (input == Input::kEnded) result = MOSQ_ERR_CONN_LOST;
  if (writable && result == MOSQ_ERR_SUCCESS) {
    result = mosquitto_loop_write(client_.get(), kPacketsAtOnce);
  }
  if (result == MOSQ_ERR_SUCCESS) result = mosquitto_loop_misc(client_.get());
  if (result != MOSQ_ERR_SUCCESS) fail(Event::Kind::kLost);
}

std::vector<MqttConnection::Event> MqttConnection::take_events() {
  return std::exchange(events_, {});
}

}  // namespace armsig::fleet
