// SPDX-License-Identifier: MIT
#include "firmware/analysis/postures/posture_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "firmware/analysis/postures/posture_problem.hpp"

namespace armsig::kinematics {
namespace {

// Samples of f over one turn of joint 6: the sharpest features that arms show are 0.2 rad wide.
constexpr int kSamples = 48;
// Where f is nearer to zero than this, snapping axes 2 and 3 to parallel may have hidden a zero.
constexpr double kNear = 0.03;
constexpr double kNearAtEdge = 0.2;  // where the arm is nearly stretched
// The square of the sine of an elbow: so far beyond its reach an arm is looked at as stretched,
// since the arm as it is may reach a little further; and with so much of it Newton's method begins
// there.
constexpr double kBeyond = 0.02;
constexpr double kOpening = 0.003;
// Departures from the form that an individual arm may have.
constexpr double kSquare = 0.05;     // rad
constexpr double kMeeting_m = 0.03;  // axes 4 and 5

using postures::ArmTurns;
using postures::kOtherElbow;
using postures::kOtherShoulder;
using postures::kWays;
using postures::PostureProblem;
using postures::Reach;
using postures::Turn;
using postures::turn_by;

// A stretch of q6 in which the point is in reach, on one way: from one edge to the other, where
// another way takes over, or a whole turn. `at` is along it: 0 and `length` at the edges, whole
// numbers at the samples in between; beyond the edges the other way goes back. Next to an edge the
// joints move with the square root of q6, so that `at` goes by that.
struct Stretch {
  unsigned way = 0;
  double first = 0;  // q6 at `at` = 1
  double last = 0;   // q6 at `at` = length - 1
  int steps = 0;     // length - 2
  bool closed = true;
  std::array<double, 2> edge{};
  std::array<unsigned, 2> other_way{};

  [[nodiscard]] double length() const { return steps + 2; }
  struct Place {
    double q6;
    unsigned way;
  };
  [[nodiscard]] Place place(double at) const {
    if (closed || (at >= 1 && at <= 1 + steps)) {
      return {first + (at - 1) * (2 * kPi / kSamples), way};
    }
    const bool begin = at < 1;
    const double from_edge = begin ? at : length() - at;
    const double edge_q6 = edge[begin ? 0 : 1];
    return {edge_q6 + ((begin ? first : last) - edge_q6) * from_edge * from_edge,
            from_edge < 0 ? other_way[begin ? 0 : 1] : way};
  }
};

class Search {
 public:
  Search(const Chain& chain, const Pose& X_0n, PostureStarts& starts)
      : chain_(chain), problem_(chain, X_0n), starts_(starts) {}

  void run() {
    for (unsigned way = 0; way < kWays; ++way) {
      std::array<bool, kSamples> inside{};
      int count = 0;
      for (int k = 0; k < kSamples; ++k) {
        inside[static_cast<std::size_t>(k)] = reach_at(sample(k), way).least() >= -kBeyond;
        count += inside[static_cast<std::size_t>(k)] ? 1 : 0;
      }
      if (count == kSamples) {
        follow({.way = way, .first = 0, .last = 0, .steps = kSamples});
        continue;
      }
      for (int k = 0; k < kSamples; ++k) {
        const auto at = [&](int i) { return inside[static_cast<std::size_t>(i % kSamples)]; };
        if (!at(k + 1) || at(k)) continue;
        int end = k + 1;
        while (at(end + 1)) ++end;
        follow(stretch(way, k + 1, end));
      }
    }
    if (starts_.empty()) add_nearest();
  }

 private:
  static double sample(int k) { return (2 * kPi / kSamples) * k; }

  [[nodiscard]] Reach reach_at(double q6, unsigned way) const {
    ArmTurns turns;
    return problem_.reach(problem_.point(turn_by(q6)), way, turns);
  }

  [[nodiscard]] Stretch stretch(unsigned way, int first, int last) const {
    Stretch found{.way = way,
                  .first = sample(first),
                  .last = sample(last),
                  .steps = last - first,
                  .closed = false};
    for (const std::size_t end : {0U, 1U}) {
      double in = end == 0 ? found.first : found.last;
      double out = in + (end == 0 ? -sample(1) : sample(1));
      constexpr int kHalvings = 45;
      for (int k = 0; k < kHalvings; ++k) {
        const double middle = 0.5 * (in + out);
        (reach_at(middle, way).least() >= -kBeyond ? in : out) = middle;
      }
      found.edge[end] = in;
      const Reach beyond = reach_at(out, way);
      found.other_way[end] = way ^ (beyond.elbow < beyond.shoulder ? kOtherElbow : kOtherShoulder);
    }
    return found;
  }

  struct Node {
    double at = 0;
    double f = 0;
    bool doubtful = false;  // f of the chain as it is may have another sign
  };

  // Nothing where the chain as it is does not reach.
  [[nodiscard]] std::optional<Node> node_at(const Stretch& on, double at, bool exactly) const {
    const auto [q6, way] = on.place(at);
    const Turn turn = turn_by(q6);
    const Vector3 P = problem_.point(turn);
    const Vector3 axis5 = problem_.axis5(turn);
    ArmTurns turns;
    const Reach reach = problem_.reach(P, way, turns);
    if (exactly && !problem_.reach_exactly(P, axis5, turns)) return std::nullopt;
    const double f = problem_.miss(turns, axis5);
    const bool doubtful =
        std::abs(f) < kNear || (reach.least() < kBeyond && std::abs(f) < kNearAtEdge);
    return Node{at, f, !exactly && doubtful};
  }

  [[nodiscard]] std::optional<double> miss(const Stretch& on, double at, bool exactly) const {
    const auto node = node_at(on, at, exactly);
    if (!node) return std::nullopt;
    return node->f;
  }

  using Nodes = FixedVector<Node, kSamples + 24>;

  // The samples of f along a stretch, with some next to its edges and across them.
  [[nodiscard]] Nodes nodes_of(const Stretch& on, bool exactly) const {
    constexpr std::array<double, 7> kEdge{-0.3, -0.15, 0, 0.15, 0.3, 0.5, 0.75};
    Nodes nodes;
    const auto add = [&](double at) {
      if (const auto node = node_at(on, at, exactly)) nodes.push_back(*node);
    };
    if (on.closed) {
      for (int k = 0; k <= kSamples + 1; ++k) add(1 + k);
      return nodes;
    }
    for (const double at : kEdge) add(at);
    for (int k = 0; k <= on.steps; ++k) add(1 + k);
    for (std::size_t k = kEdge.size(); k-- > 0;) add(on.length() - kEdge[k]);
    return nodes;
  }

  void follow(const Stretch& on) {
    Nodes nodes = nodes_of(on, false);
    double largest = 0;
    for (const Node& node : nodes) largest = std::max(largest, std::abs(node.f));
    const bool exactly = largest < kNear;
    if (exactly) nodes = nodes_of(on, true);
    look(on, nodes, exactly);
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      std::size_t end = k;
      while (end < nodes.size() && nodes[end].doubtful) ++end;
      if (end < k + 2) continue;
      for (std::size_t i = k > 0 ? k - 1 : 0; i < end && i + 1 < nodes.size(); i += 2) {
        look_closely(on, nodes[i].at, nodes[std::min(i + 3, nodes.size() - 1)].at);
      }
      k = end;
    }
  }

  // Changes of sign between neighbours, and approaches to zero without one.
  void look(const Stretch& on, const Nodes& nodes, bool exactly) {
    for (std::size_t k = 0; k + 1 < nodes.size(); ++k) {
      const Node& here = nodes[k];
      const Node& next = nodes[k + 1];
      if ((here.f > 0) != (next.f > 0)) add_zero(on, here, next, exactly);
      if (k == 0) continue;
      const Node& before = nodes[k - 1];
      const double sign = here.f > 0 ? 1 : -1;
      const bool nearest = sign * here.f <= sign * before.f && sign * here.f <= sign * next.f;
      if (nearest && sign * before.f > 0 && sign * next.f > 0) {
        approach(on, before, here, next, exactly);
      }
    }
  }

  // The zero between two places where f has two signs (regula falsi, Illinois).
  void add_zero(const Stretch& on, Node a, Node b, bool exactly) {
    const double tolerance = exactly ? 1e-13 : 1e-3;
    constexpr int kMost = 60;
    for (int k = 0; k < kMost && std::abs(b.at - a.at) > tolerance; ++k) {
      const double at = (a.f * b.at - b.f * a.at) / (a.f - b.f);
      const auto f = miss(on, at, exactly);
      if (!f || *f == 0) {
        a = b = {at, 0};
        break;
      }
      if ((*f > 0) == (b.f > 0)) {
        a.f *= 0.5;
      } else {
        a = b;
      }
      b = {at, *f};
    }
    add_start(on, b.at, exactly);
  }

  // The least |f| between the neighbours of `here` (golden section), two zeros if it changes sign.
  void approach(const Stretch& on, const Node& before, const Node& here, const Node& after,
                bool exactly) {
    constexpr double kGolden = 0.38196601125010515;
    constexpr double kTouches = 1e-8;
    const double sign = here.f > 0 ? 1 : -1;
    const int most = exactly ? 40 : 8;
    const auto f_at = [&](double at) {
      const auto f = miss(on, at, exactly);
      return Node{at, f ? sign * *f : 1.0};
    };
    double low = before.at;
    double high = after.at;
    Node left = f_at(low + kGolden * (high - low));
    Node right = f_at(high - kGolden * (high - low));
    Node best{here.at, sign * here.f};
    for (int k = 0; k < most && best.f > 0; ++k) {
      for (const Node& node : {left, right}) {
        if (node.f < best.f) best = node;
      }
      if (left.f < right.f) {
        high = right.at;
        right = left;
        left = f_at(low + kGolden * (high - low));
      } else {
        low = left.at;
        left = right;
        right = f_at(high - kGolden * (high - low));
      }
    }
    if (best.f <= 0) {
      const Node bottom{best.at, sign * best.f};
      add_zero(on, before, bottom, exactly);
      add_zero(on, bottom, after, exactly);
    } else if (!exactly && best.f < kNear) {
      look_closely(on, before.at, after.at);
    } else if (exactly && best.f < kTouches) {
      add_start(on, best.at, true);
    }
  }

  // On the chain as it is.
  void look_closely(const Stretch& on, double from, double to) {
    constexpr int kParts = 16;
    Nodes nodes;
    for (int k = 0; k <= kParts; ++k) {
      const double at = from + (to - from) * k / kParts;
      if (const auto f = miss(on, at, true)) nodes.push_back({at, *f});
    }
    look(on, nodes, true);
  }

  void add_start(const Stretch& on, double at, bool exactly) {
    const auto [q6, way] = on.place(at);
    add(q6, way, exactly);
  }

  void add(double q6, unsigned way, bool exactly) {
    const Turn turn = turn_by(q6);
    const Vector3 P = problem_.point(turn);
    const Vector3 axis5 = problem_.axis5(turn);
    ArmTurns turns;
    const Reach reach = problem_.reach(P, way, turns);
    ArmTurns exact = turns;
    if (exactly && problem_.reach_exactly(P, axis5, exact)) turns = exact;
    add(turns, axis5, turn);
    if (reach.least() >= kOpening) return;
    problem_.reach(P, way, turns, kOpening);
    add(turns, axis5, turn);
  }

  void add(ArmTurns turns, const Vector3& axis5, const Turn& turn) {
    if (starts_.full()) return;
    problem_.turn_joint4(problem_.in_frame3(turns, axis5), turns);
    JointVector q;
    const auto all = problem_.all_turns(turns, turn);
    for (std::size_t i = 0; i < 6; ++i) {
      q.push_back(wrap_angle(all[i].angle() - chain_.theta[i]));
    }
    starts_.push_back(q);
  }

  // Of a pose out of reach on all ways: the turns of joint 6 where the point is nearest to it.
  void add_nearest() {
    for (unsigned way = 0; way < kWays; ++way) {
      int best = 0;
      double most = reach_at(0, way).least();
      for (int k = 1; k < kSamples; ++k) {
        const double inside = reach_at(sample(k), way).least();
        if (inside <= most) continue;
        most = inside;
        best = k;
      }
      add(sample(best), way, false);
    }
  }

  const Chain& chain_;
  PostureProblem problem_;
  PostureStarts& starts_;
};

}  // namespace

bool can_search_postures(const Chain& chain) {
  if (chain.joint_count != 6 || chain.has_prismatic) return false;
  constexpr double kLeastLink = 1e-3;
  constexpr double kLeastTwist = 0.3;
  const double upper = std::hypot(chain.x[1], chain.y[1]);
  return std::abs(chain.cos_alpha[0]) < kSquare && std::abs(chain.sin_alpha[1]) < kSquare &&
         std::abs(chain.sin_alpha[3]) > kLeastTwist && std::abs(chain.x[3]) < kMeeting_m &&
         upper > kLeastLink;
}

PostureStarts search_postures(const Chain& chain, const Pose& X_0n) {
  PostureStarts starts;
  Search(chain, X_0n, starts).run();
  return starts;
}

}  // namespace armsig::kinematics
