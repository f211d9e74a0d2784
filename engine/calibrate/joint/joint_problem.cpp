#include "engine/calibrate/joint/joint_problem.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include <ceres/ceres.h>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/SparseCore>

#include "engine/base/check.h"
#include "engine/base/parallel.h"

namespace rayloc {
namespace {

constexpr double kMinSurveySigma = 0.001;  // [m], chosen: no survey is better ...
constexpr double kMaxSurveySigma = 0.1;    // [m], chosen: ... or worse than this

// All values that Ceres changes, contiguous: its parameter blocks point into them.
struct Values {
  std::vector<double> room;                   // of each unknown
  std::vector<std::array<double, 3>> survey;  // [m], of each point
};

JointState state_of(const Values& values) {
  JointState state{values.room, {}};
  for (const auto& error : values.survey) {
    state.survey.push_back({error[0], error[1], error[2]});
  }
  return state;
}

// Residuals and derivatives of all samples, computed at once by all threads before Ceres requests
// them one by one: the order in which Ceres sums does not depend on the threads.
class Evaluations : public ceres::EvaluationCallback {
 public:
  Evaluations(const JointContext& context,
              const Values& values,
              std::vector<std::vector<std::uint32_t>> unknowns)
      : context_(context),
        values_(values),
        unknowns_(std::move(unknowns)),
        results_(context.samples.size()) {}

  void PrepareForEvaluation(bool derivatives, bool /*moved*/) override {
    const std::vector<double> change = context_.change(values_.room);
    parallel_for(context_.samples.size(), 1, [&](std::size_t i) {
      const auto& survey = values_.survey[context_.samples[i].traced->point];
      const ModelPoint at{change, {survey[0], survey[1], survey[2]}};
      results_[i] =
          context_.model.residual(*context_.samples[i].traced,
                                  *context_.samples[i].measured,
                                  at,
                                  derivatives ? std::span<const std::uint32_t>(unknowns_[i])
                                              : std::span<const std::uint32_t>());
    });
  }

  const SampleResidual& result(std::size_t sample) const { return results_[sample]; }
  const std::vector<std::uint32_t>& unknowns(std::size_t sample) const { return unknowns_[sample]; }

 private:
  JointContext context_;
  const Values& values_;
  std::vector<std::vector<std::uint32_t>> unknowns_;
  std::vector<SampleResidual> results_;
};

// Real and imaginary parts of one sample's residual; the survey's block is the first.
class SampleCost : public ceres::CostFunction {
 public:
  SampleCost(const Evaluations& evaluations, std::size_t sample, Eigen::Index coordinates)
      : evaluations_(evaluations), sample_(sample), coordinates_(coordinates) {
    set_num_residuals(static_cast<int>(2 * coordinates));
    mutable_parameter_block_sizes()->push_back(3);
    for (std::size_t i = 0; i < evaluations.unknowns(sample).size(); ++i) {
      mutable_parameter_block_sizes()->push_back(1);
    }
  }

  bool Evaluate(const double* const* /*blocks*/,
                double* residuals,
                double** jacobians) const override {
    const SampleResidual& result = evaluations_.result(sample_);
    Eigen::Map<Eigen::VectorXd> out(residuals, 2 * coordinates_);
    out << result.value.real(), result.value.imag();
    if (jacobians == nullptr) {
      return true;
    }
    if (jacobians[0] != nullptr) {
      using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
      Eigen::Map<RowMajor> by_survey(jacobians[0], 2 * coordinates_, 3);
      by_survey << result.by_survey.real(), result.by_survey.imag();
    }
    for (Eigen::Index i = 0; i < result.derivative.cols(); ++i) {
      if (double* column = jacobians[i + 1]; column != nullptr) {
        Eigen::Map<Eigen::VectorXd> derivative(column, 2 * coordinates_);
        derivative << result.derivative.col(i).real(), result.derivative.col(i).imag();
      }
    }
    return true;
  }

 private:
  const Evaluations& evaluations_;
  std::size_t sample_;
  Eigen::Index coordinates_;
};

// A Gaussian prior about 0 with as many dimensions as the block.
class PriorCost : public ceres::CostFunction {
 public:
  PriorCost(int size, double sigma) : size_(size), scale_(1.0 / sigma) {
    set_num_residuals(size);
    mutable_parameter_block_sizes()->push_back(size);
  }
  bool Evaluate(const double* const* blocks, double* residuals, double** jacobians) const override {
    for (int i = 0; i < size_; ++i) {
      residuals[i] = scale_ * blocks[0][i];
      for (int j = 0; jacobians != nullptr && jacobians[0] != nullptr && j < size_; ++j) {
        jacobians[0][i * size_ + j] = i == j ? scale_ : 0.0;
      }
    }
    return true;
  }

 private:
  int size_;
  double scale_;
};

class StopOnRequest : public ceres::IterationCallback {
 public:
  StopOnRequest(const JointContext& context, const Values& values, const JointObserver& observer)
      : context_(context), values_(values), observer_(observer) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& /*summary*/) override {
    return !observer_ || observer_(mean_unexplained(context_, state_of(values_)))
               ? ceres::SOLVER_CONTINUE
               : ceres::SOLVER_TERMINATE_SUCCESSFULLY;
  }

 private:
  const JointContext& context_;
  const Values& values_;
  const JointObserver& observer_;
};

// The released unknowns that the sample's rays depend on, ascending.
std::vector<std::uint32_t> unknowns_of(const TracedSample& sample, std::span<const char> released) {
  std::vector<std::uint32_t> result;
  for (const RayTerm& term : sample.terms) {
    if (released[term.unknown] != 0) {
      result.push_back(term.unknown);
    }
  }
  const auto elements = static_cast<std::uint32_t>(sample.rays.size());
  for (std::uint32_t i = 0; i < 2 * elements * (elements - 1); ++i) {
    if (released[sample.coupling + i] != 0) {
      result.push_back(sample.coupling + i);
    }
  }
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

// The Ceres problem and all data that its blocks point to.
struct Assembled {
  Values values;
  std::unique_ptr<Evaluations> evaluations;
  std::unique_ptr<ceres::LossFunction> loss;
  std::unique_ptr<ceres::Problem> problem;
  std::vector<std::uint32_t> released;  // unknowns that some sample depends on
  std::vector<std::size_t> points;      // that have a sample
};

void add_priors(const JointContext& context,
                const JointOptions& options,
                std::span<const char> used,
                std::span<const char> used_point,
                Assembled& assembled) {
  ceres::Problem& problem = *assembled.problem;
  Values& values = assembled.values;
  for (std::size_t p = 0; p < used_point.size(); ++p) {
    if (used_point[p] == 0) {
      continue;
    }
    assembled.points.push_back(p);
    if (options.survey_sigma > 0.0) {
      problem.AddResidualBlock(
          new PriorCost(3, options.survey_sigma), nullptr, values.survey[p].data());
    } else {
      problem.SetParameterBlockConstant(values.survey[p].data());
    }
  }
  for (std::uint32_t unknown = 0; unknown < used.size(); ++unknown) {
    if (used[unknown] != 0) {
      assembled.released.push_back(unknown);
      problem.AddResidualBlock(
          new PriorCost(1, context.unknowns[unknown].sigma), nullptr, &values.room[unknown]);
    }
  }
}

void assemble(const JointContext& context,
              const JointOptions& options,
              const JointState& state,
              Assembled& assembled) {
  Values& values = assembled.values;
  values.room = state.values;
  for (const Vec3d& error : state.survey) {
    values.survey.push_back({error.x, error.y, error.z});
  }
  std::vector<std::vector<std::uint32_t>> each;
  std::vector<char> used(context.unknowns.size());
  std::vector<char> used_point(values.survey.size());
  for (const JointSample& sample : context.samples) {
    each.push_back(unknowns_of(*sample.traced, options.released));
    for (const std::uint32_t unknown : each.back()) {
      used[unknown] = 1;
    }
    used_point[sample.traced->point] = 1;
  }
  assembled.evaluations = std::make_unique<Evaluations>(context, values, std::move(each));
  ceres::Problem::Options problem_options;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.evaluation_callback = assembled.evaluations.get();
  assembled.problem = std::make_unique<ceres::Problem>(problem_options);
  ceres::Problem& problem = *assembled.problem;
  // rho(s) = 2 kEvidence ln(1 + s / floor), half of which
  // is the cost.
  assembled.loss =
      std::make_unique<ceres::ScaledLoss>(new ceres::CauchyLoss(std::sqrt(options.floor)),
                                          2.0 * kEvidence / options.floor,
                                          ceres::TAKE_OWNERSHIP);
  for (std::size_t i = 0; i < context.samples.size(); ++i) {
    std::vector<double*> blocks{values.survey[context.samples[i].traced->point].data()};
    for (const std::uint32_t unknown : assembled.evaluations->unknowns(i)) {
      blocks.push_back(&values.room[unknown]);
    }
    problem.AddResidualBlock(
        new SampleCost(*assembled.evaluations, i, context.samples[i].measured->y.size()),
        assembled.loss.get(),
        blocks);
  }
  add_priors(context, options, used, used_point, assembled);
}

// J^T J, including priors, of the released unknowns followed by the survey errors of the points,
// three each (where these are free).
Eigen::MatrixXd information_of(Assembled& assembled, const JointOptions& options) {
  ceres::Problem::EvaluateOptions evaluate;
  for (const std::uint32_t unknown : assembled.released) {
    evaluate.parameter_blocks.push_back(&assembled.values.room[unknown]);
  }
  if (options.survey_sigma > 0.0) {
    for (const std::size_t point : assembled.points) {
      evaluate.parameter_blocks.push_back(assembled.values.survey[point].data());
    }
  }
  ceres::CRSMatrix crs;
  const bool evaluated = assembled.problem->Evaluate(evaluate, nullptr, nullptr, nullptr, &crs);
  RAYLOC_CHECK(evaluated);  // every sample's residual is finite
  const Eigen::Map<const Eigen::SparseMatrix<double, Eigen::RowMajor>> jacobian(
      crs.num_rows,
      crs.num_cols,
      static_cast<Eigen::Index>(crs.values.size()),
      crs.rows.data(),
      crs.cols.data(),
      crs.values.data());
  return Eigen::SparseMatrix<double>(jacobian.transpose() * jacobian);
}

// Along each axis that the measurements determine independently of the others: `survey_info`, their
// information [1/m^2], and the error [m] found with an expected variance of `assumed`. Without that
// prior the error would be larger, the more so the less the information; axes with little
// information have little weight. Their noise is not subtracted: the information is of tempered
// evidence.
double spread_of(const Eigen::VectorXd& survey_info, const Eigen::VectorXd& error, double assumed) {
  double sum = 0.0;
  double weights = 0.0;
  for (Eigen::Index i = 0; i < survey_info.size(); ++i) {
    if (survey_info[i] > 0.0) {
      const double share = survey_info[i] * assumed / (1.0 + survey_info[i] * assumed);
      sum += error[i] * error[i];  // (error / share)^2, weighted by share^2
      weights += share * share;
    }
  }
  return weights > 0.0 ? std::clamp(std::sqrt(sum / weights), kMinSurveySigma, kMaxSurveySigma)
                       : std::sqrt(assumed);
}

}  // namespace

JointState between(const JointState& from, const JointState& to, double share) {
  JointState result = to;
  for (std::size_t i = 0; i < to.values.size(); ++i) {
    result.values[i] = std::lerp(from.values[i], to.values[i], share);
  }
  for (std::size_t i = 0; i < to.survey.size(); ++i) {
    result.survey[i] = from.survey[i] + share * (to.survey[i] - from.survey[i]);
  }
  return result;
}

std::vector<double> JointContext::change(std::span<const double> values) const {
  std::vector<double> result(values.begin(), values.end());
  for (std::size_t i = 0; i < result.size(); ++i) {
    result[i] -= traced_at[i];
  }
  return result;
}

double mean_unexplained(const JointContext& context, const JointState& state) {
  const std::vector<double> change = context.change(state.values);
  std::vector<double> each(context.samples.size());
  parallel_for(each.size(), 1, [&](std::size_t i) {
    const JointSample& sample = context.samples[i];
    each[i] = context.model.unexplained(
        *sample.traced, *sample.measured, {change, state.survey[sample.traced->point]});
  });
  double sum = 0.0;
  for (const double one : each) {
    sum += one;
  }
  return each.empty() ? 0.0 : sum / static_cast<double>(each.size());
}

double JointProblem::solve(const JointOptions& options,
                           JointState& state,
                           const JointObserver& observer) const {
  Assembled assembled;
  assemble(context_, options, state, assembled);
  ceres::Solver::Options solver;
  solver.max_num_iterations = options.iterations;
  solver.linear_solver_type =
      options.survey_sigma > 0.0 ? ceres::DENSE_SCHUR : ceres::DENSE_NORMAL_CHOLESKY;
  solver.function_tolerance = 1e-5;
  solver.initial_trust_region_radius = 1e3;
  solver.logging_type = ceres::SILENT;
  solver.num_threads = 1;
  auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  if (options.survey_sigma > 0.0) {
    for (const std::size_t point : assembled.points) {
      ordering->AddElementToGroup(assembled.values.survey[point].data(), 0);
    }
    for (const std::uint32_t unknown : assembled.released) {
      ordering->AddElementToGroup(&assembled.values.room[unknown], 1);
    }
    solver.linear_solver_ordering = ordering;
  }
  StopOnRequest stop(context_, assembled.values, observer);
  solver.update_state_every_iteration = true;  // the observer reads it
  solver.callbacks.push_back(&stop);
  ceres::Solver::Summary summary;
  ceres::Solve(solver, assembled.problem.get(), &summary);
  if (summary.IsSolutionUsable()) {
    state = state_of(assembled.values);
  }
  return summary.final_cost;
}

double JointProblem::cost(const JointOptions& options, const JointState& state) const {
  Assembled assembled;
  assemble(context_, options, state, assembled);
  double cost = 0.0;
  assembled.problem->Evaluate({}, &cost, nullptr, nullptr, nullptr);
  return cost;
}

std::vector<double> JointProblem::posterior(const JointOptions& options,
                                            const JointState& state) const {
  Assembled assembled;
  assemble(context_, options, state, assembled);
  const Eigen::MatrixXd information = information_of(assembled, options);
  const Eigen::LLT<Eigen::MatrixXd> factor(information);
  const auto count = static_cast<Eigen::Index>(assembled.released.size());
  // Row i of inverse(L)^T: variance_i = |inverse(L) e_i|^2.
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(information.rows(), count);
  inverse.topRows(count).setIdentity();
  factor.matrixL().solveInPlace(inverse);
  std::vector<double> sigma(context_.unknowns.size());
  for (Eigen::Index i = 0; i < count; ++i) {
    sigma[assembled.released[static_cast<std::size_t>(i)]] = inverse.col(i).norm();
  }
  return sigma;
}

double JointProblem::survey_sigma(const JointOptions& options, const JointState& state) const {
  RAYLOC_CHECK(options.survey_sigma > 0.0);
  Assembled assembled;
  assemble(context_, options, state, assembled);
  const Eigen::MatrixXd all = information_of(assembled, options);
  const auto room = static_cast<Eigen::Index>(assembled.released.size());
  const Eigen::Index survey = all.rows() - room;
  const double assumed = options.survey_sigma * options.survey_sigma;
  // Information of the measurements on the errors, the room integrated out.
  Eigen::MatrixXd survey_info = all.bottomRightCorner(survey, survey);
  survey_info.diagonal().array() -= 1.0 / assumed;
  if (room > 0) {
    const auto shared = all.topRightCorner(room, survey);
    survey_info -= shared.transpose() * all.topLeftCorner(room, room).llt().solve(shared);
  }
  Eigen::VectorXd error(survey);
  for (std::size_t i = 0; i < assembled.points.size(); ++i) {
    const auto& of_point = assembled.values.survey[assembled.points[i]];
    error.segment<3>(static_cast<Eigen::Index>(3 * i)) << of_point[0], of_point[1], of_point[2];
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(survey_info);
  return spread_of(eigen.eigenvalues(), eigen.eigenvectors().transpose() * error, assumed);
}

}  // namespace rayloc
