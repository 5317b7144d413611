// SPDX-License-Identifier: MIT
#include "core/calibration/signature_of_model.hpp"

#include <cmath>

#include "core/calibration/engine_detail.hpp"

namespace armsig::calibration {

namespace {

// The model at the signature configuration, with what gravity and maps are there.
struct Configuration {
  std::array<Pose, kMaxJoints> X_SJ;
  JointVector effective;
  FixedVector<Pose, kMaxFrames> X_SL;
};

Configuration at_configuration(const ArmModel& model, const JointVector& effective) {
  const JointVector readings = readings_for(model.couplings, effective);
  Configuration found;
  ChainFrames frames;
  for (std::size_t link = 0; link <= model.joint_count(); ++link) {
    evaluate_chain(model, readings, link, frames);
    found.X_SL.push_back(frames.X_SL);
  }
  found.X_SJ = frames.X_SJ;
  found.effective = effective;
  return found;
}

// X with its z axis turned onto the line of `axis`, and its origin put there, by the shortest way.
Pose onto_line(const Pose& X, const Pose& axis, bool revolute) {
  Pose moved = X;
  const Vector3 z = X.R.col(2);
  const Vector3 to = axis.R.col(2);
  const Vector3 turn = z.cross(to);
  if (const double sine = turn.norm(); sine > 0) {
    moved.R = rotation_about(turn / sine, std::atan2(sine, z.dot(to))) * X.R;
  }
  if (revolute) moved.p = axis.p + to * to.dot(X.p - axis.p);
  return moved;
}

// What the unknowns of the layout do when those of the engine's geometry block move by one.
class Transfer {
 public:
  Transfer(const ArmModel& model, const Configuration& at, std::size_t targets,
           const Refined& refined)
      : model_(model), at_(at), targets_(targets), refined_(refined) {}

  // Of the geometry block, gravity apart.
  [[nodiscard]] std::size_t columns() const { return further_column() + model_.further.size(); }

  // Row `unknown` of the layout.
  void row(std::size_t unknown, std::array<double, kMaxGeometry>& M) const {
    M.fill(0);
    const Parameter& parameter = refined_.layout.parameters[unknown];
    if (const std::size_t k = further(parameter); k < model_.further.size()) {
      M[further_column() + k] = 1;
      return;
    }
    const Signature& signature = refined_.signature;
    const auto component = static_cast<Eigen::Index>(parameter.component);
    const std::size_t index = parameter.index;
    if (parameter.kind == ParameterKind::kTarget) {
      const Target& target = signature.targets[index];
      add_motions(target.link, target.p_S, Vector3::Unit(component), M);
      const Vector3 row = at_.X_SL[target.link].R.row(component);
      for (std::size_t c = 0; c < 3; ++c) {
        M[target_column(index) + c] = row[static_cast<Eigen::Index>(c)];
      }
      return;
    }
    const Pose& X = signature.X_SL[index];
    const Vector3 along = X.R.col(component);
    if (parameter.kind == ParameterKind::kAxisPosition) {
      add_motions(index, X.p, along, M);
      add_deviation(index, X.p, along, M);
      return;
    }
    add_turns(index, along, M);
    const Pose& own = at_.X_SJ[index];
    M[joint_column(index)] = own.R.col(0).dot(along);
    M[joint_column(index) + 1] = own.R.col(1).dot(along);
  }

 private:
  static std::size_t target_column(std::size_t target) { return 6 + 3 * target; }
  [[nodiscard]] std::size_t joint_column(std::size_t joint) const {
    return target_column(targets_) + kDeviations * joint;
  }
  [[nodiscard]] std::size_t further_column() const { return joint_column(model_.joint_count()); }
  // The index of a correction among those of the model, or their number.
  [[nodiscard]] std::size_t further(const Parameter& parameter) const {
    std::size_t k = 0;
    for (; k < model_.further.size(); ++k) {
      const Parameter& other = model_.further[k];
      if (other.kind == parameter.kind && other.index == parameter.index &&
          other.component == parameter.component) {
        break;
      }
    }
    return k;
  }
  // What turning joint j by one does, its corrections do in proportion.
  void add_corrections(std::size_t joint, double turned,
                       std::array<double, kMaxGeometry>& M) const {
    M[joint_column(joint) + 4] = turned;
    for (std::size_t k = 0; k < model_.further.size(); ++k) {
      const Parameter& parameter = model_.further[k];
      if (!of_reading(parameter) || parameter.index != joint) continue;
      M[further_column() + k] = turned * turn_by(parameter, at_.effective[joint]);
    }
  }
  // By the base and the joints before `link`: how they move a point of that link along `along`.
  void add_motions(std::size_t link, const Vector3& p_S, const Vector3& along,
                   std::array<double, kMaxGeometry>& M) const {
    for (std::size_t c = 0; c < 3; ++c) {
      const Vector3 unit = Vector3::Unit(static_cast<Eigen::Index>(c));
      M[c] = unit.cross(p_S - model_.X_SB.p).dot(along);
      M[3 + c] = unit.dot(along);
    }
    for (std::size_t j = 0; j < link; ++j) {
      add_deviation(j, p_S, along, M);
      const bool revolute = model_.joints[j].type == JointType::kRevolute;
      add_corrections(j, motion_of(revolute, at_.X_SJ[j], p_S).dot(along), M);
    }
  }
  void add_deviation(std::size_t joint, const Vector3& p_S, const Vector3& along,
                     std::array<double, kMaxGeometry>& M) const {
    const Pose& X = at_.X_SJ[joint];
    const std::size_t first = joint_column(joint);
    for (std::size_t c = 0; c < 2; ++c) {
      const Vector3 axis = X.R.col(static_cast<Eigen::Index>(c));
      M[first + c] = axis.cross(p_S - X.p).dot(along);
      M[first + 2 + c] = axis.dot(along);
    }
  }
  // The same of directions.
  void add_turns(std::size_t link, const Vector3& along,
                 std::array<double, kMaxGeometry>& M) const {
    for (std::size_t c = 0; c < 3; ++c) M[c] = along[static_cast<Eigen::Index>(c)];
    for (std::size_t j = 0; j < link; ++j) {
      const Pose& X = at_.X_SJ[j];
      const std::size_t first = joint_column(j);
      M[first] = X.R.col(0).dot(along);
      M[first + 1] = X.R.col(1).dot(along);
      if (model_.joints[j].type == JointType::kRevolute) {
        add_corrections(j, X.R.col(2).dot(along), M);
      }
    }
  }

  const ArmModel& model_;
  const Configuration& at_;
  std::size_t targets_;
  const Refined& refined_;
};

class OfEngine final : public GeometryCovariance {
 public:
  explicit OfEngine(const Engine& engine) : engine_(engine) {}
  void times(std::array<double, kMaxGeometry>& b) const override { engine_.times_covariance(b); }

 private:
  const Engine& engine_;
};

// R with (R^T R)^-1 = P, P = L L^T scaled to a unit diagonal: column by column of L^-1, absorbed.
Result<void> invert(std::span<double> P, std::size_t size, SquareRootFactor& information) {
  const auto at = [&](std::size_t i, std::size_t j) -> double& { return P[i * size + j]; };
  std::array<double, kMaxParameters> sigma{};
  for (std::size_t i = 0; i < size; ++i) {
    if (!(at(i, i) > 0)) return std::unexpected(Error::kSingular);
    sigma[i] = std::sqrt(at(i, i));
  }
  information.reset(size);
  RowBlock<1> block;
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = at(i, j) / (sigma[i] * sigma[j]);
      for (std::size_t k = 0; k < j; ++k) sum -= at(i, k) * at(j, k);
      if (i == j && !(sum > 0)) return std::unexpected(Error::kSingular);
      at(i, j) = i == j ? std::sqrt(sum) : sum / at(j, j);
    }
  }
  // Rows of L^-1, which with their sigmas are rows of an information whose inverse is P.
  for (std::size_t i = 0; i < size; ++i) {
    block.clear(size);
    auto& row = block.rows[0];
    for (std::size_t j = i + 1; j-- > 0;) {
      double sum = j == i ? 1 : 0;
      for (std::size_t k = j + 1; k <= i; ++k) sum -= row[k] * at(k, j);
      row[j] = sum / at(j, j);
    }
    for (std::size_t j = 0; j <= i; ++j) row[j] /= sigma[j];
    information.absorb(block);
  }
  return {};
}

}  // namespace

namespace {

void put_axes(const Configuration& at, const ArmModel& model, std::span<const ModelTarget> targets,
              Signature& signature) {
  for (std::size_t t = 0; t < targets.size(); ++t) {
    if (targets[t].rows == 0) continue;
    signature.targets[t].p_S = at.X_SL[targets[t].link] * targets[t].p_L;
  }
  const std::size_t n = model.joint_count();
  const Pose X_last = signature.X_SL[n - 1].inverse() * signature.X_SL[n];
  for (std::size_t i = 0; i < n; ++i) {
    signature.X_SL[i] =
        onto_line(signature.X_SL[i], at.X_SJ[i], model.joints[i].type == JointType::kRevolute);
  }
  signature.X_SL[n] = signature.X_SL[n - 1] * X_last;
}

}  // namespace

void axes_to_signature(const ArmModel& model, std::span<const ModelTarget> targets,
                       Signature& signature) {
  put_axes(at_configuration(model, signature.configuration), model, targets, signature);
}

Judged<void> geometry_to_signature(const ArmModel& model, std::span<const ModelTarget> targets,
                                   const Engine& engine, Refined& refined,
                                   const ParameterRequest& request, std::span<double> scratch) {
  return geometry_to_signature(model, targets, OfEngine(engine), refined, request, scratch);
}

Judged<void> geometry_to_signature(const ArmModel& model, std::span<const ModelTarget> targets,
                                   const GeometryCovariance& found, Refined& refined,
                                   const ParameterRequest& request, std::span<double> scratch) {
  Signature& signature = refined.signature;
  const Configuration at = at_configuration(model, signature.configuration);
  std::array<bool, kMaxTargets> observed{};
  for (std::size_t t = 0; t < targets.size(); ++t) observed[t] = targets[t].rows > 0;
  put_axes(at, model, targets, signature);
  ARMSIG_TRY(layout, make_layout(signature, observed, request, model.sensor.receivers.size()));
  refined.layout = layout;
  const std::size_t size = layout.size();
  ARMSIG_CHECK(scratch.size() >= kMaxParameters * kMaxParameters);
  const Transfer transfer(model, at, targets.size(), refined);
  std::array<double, kMaxGeometry> row;
  for (std::size_t i = 0; i < size; ++i) {
    transfer.row(i, row);
    found.times(row);
    std::array<double, kMaxGeometry> other;
    for (std::size_t j = 0; j <= i; ++j) {
      transfer.row(j, other);
      double sum = 0;
      for (std::size_t c = 0; c < transfer.columns(); ++c) sum += row[c] * other[c];
      scratch[i * size + j] = sum;
    }
  }
  for (std::size_t t = 0; t < targets.size(); ++t) {
    if (!observed[t]) continue;
    const std::size_t first = layout.target[t];
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        const double value = scratch[(first + a) * size + first + b];
        Matrix3& covariance = signature.targets[t].covariance_m2;
        covariance(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) = value;
        covariance(static_cast<Eigen::Index>(b), static_cast<Eigen::Index>(a)) = value;
      }
    }
  }
  if (const auto done = invert(scratch, size, refined.information); !done) {
    return std::unexpected(Refusal{done.error(), 0, 0});
  }
  return {};
}

}  // namespace armsig::calibration
