// SPDX-License-Identifier: MIT
// A long computation as a list of what is left to do of it, so that it can be done a bounded part
// at a time: what is next stands on top, and what has parts of its own puts them there.
#pragma once

#include <algorithm>
#include <cstddef>
#include <initializer_list>

#include "core/base/fixed_vector.hpp"

namespace armsig::calibration {

// Some of the units (rows, columns, ...) that a task goes through one after the other.
struct Units {
  std::size_t first = 0;
  std::size_t last = 0;  // the one behind
};

template <typename Doer, std::size_t kMostTasks>
class Agenda {
 public:
  // Either done at once, or unit by unit. `work`: multiplications, about, of it or of a unit.
  struct Task {
    using Once = void (Doer::*)();
    using Pass = void (Doer::*)(Units);

    constexpr Task() = default;
    constexpr explicit(false) Task(Once what, std::size_t how_much = 1)
        : once(what), work(how_much) {}
    constexpr Task(Pass what, std::size_t units, std::size_t how_much)
        : pass(what), count(units), work(how_much) {}

    Once once = nullptr;
    Pass pass = nullptr;
    std::size_t count = 1;
    std::size_t work = 1;
  };

  void clear() {
    tasks_.clear();
    done_ = 0;
  }
  [[nodiscard]] bool empty() const { return tasks_.empty(); }

  // Before everything else that is left, in this order.
  void put(std::initializer_list<Task> tasks) {
    for (auto task = tasks.end(); task != tasks.begin();) tasks_.push_back(*--task);
  }

  // As much of what is left as `work` allows, but at least a unit.
  void go_on(Doer& doer, std::size_t work) {
    if (empty()) return;
    std::size_t done = some(doer, work);
    while (!empty() && done + tasks_.back().work <= work) done += some(doer, work - done);
  }

 private:
  // Returns the work.
  std::size_t some(Doer& doer, std::size_t work) {
    const Task task = tasks_.back();
    if (task.once != nullptr) {
      drop();
      (doer.*task.once)();
      return task.work;
    }
    const std::size_t units =
        std::min(std::max(work / task.work, std::size_t{1}), task.count - done_);
    const Units part{done_, done_ + units};
    done_ += units;
    if (done_ == task.count) drop();
    (doer.*task.pass)(part);
    return units * task.work;
  }

  void drop() {
    tasks_.resize(tasks_.size() - 1);
    done_ = 0;
  }

  FixedVector<Task, kMostTasks> tasks_;
  std::size_t done_ = 0;  // units of the task on top
};

}  // namespace armsig::calibration
