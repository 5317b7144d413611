// SPDX-License-Identifier: MIT
#include "hal/modbus/rtu_master.hpp"

#include <span>

#include "core/base/check.hpp"

namespace armsig::modbus {

bool RtuMaster::idle(hal::Instant now) const {
  return !request_ && (!last_byte_at_ || now - *last_byte_at_ >= frame_pause(timing_.baud));
}

Result<void> RtuMaster::start(const ReadRequest& request, hal::Instant now) {
  ARMSIG_CHECK(idle(now));
  for (int portions = 0; portions < 4; ++portions) {  // bounded, should the line babble
    ARMSIG_TRY(thrown_away, line_->read(buffer_));
    if (thrown_away == 0) break;
  }
  const auto bytes = encode(request);
  if (auto sent = line_->write(bytes); !sent) return sent;
  request_ = request;
  started_at_ = now;
  last_byte_at_ = now;
  size_ = 0;
  return {};
}

std::optional<std::expected<Registers, Failure>> RtuMaster::poll(hal::Instant now) {
  if (!request_) return std::nullopt;
  const auto count = line_->read(std::span(buffer_).subspan(size_));
  if (!count) {
    request_.reset();
    return std::unexpected(Failure{count.error(), 0});
  }
  size_ += *count;
  if (*count > 0) last_byte_at_ = now;
  const std::size_t whole = answer_bytes(std::span(buffer_).first(size_));
  if ((whole > 0 && size_ >= whole) || size_ == kMaxFrameBytes) return finish();
  if (size_ > 0 && now - *last_byte_at_ >= frame_pause(timing_.baud)) return finish();
  if (size_ == 0 && now - started_at_ >= timing_.answer_timeout) {
    request_.reset();
    return std::unexpected(Failure{Error::kSensorSilent, 0});
  }
  return std::nullopt;
}

std::optional<std::expected<Registers, Failure>> RtuMaster::finish() {
  const ReadRequest request = *request_;
  request_.reset();
  return decode(request, std::span(buffer_).first(size_));
}

}  // namespace armsig::modbus
