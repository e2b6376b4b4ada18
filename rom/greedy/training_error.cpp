#include "training_error.hpp"

#include <Eigen/QR>
#include <string>
#include <utility>

namespace tact {

TrainingError::TrainingError(const Shared<ContactFamily>& family, TrainingMethod method, TrainingContact contact,
                             std::vector<Parameter> samples)
    : family_(family), method_(std::move(method)), contact_(std::move(contact)), samples_(std::move(samples)) {
    if (samples_.empty()) throw InputError("TrainingError: there are no samples, expected at least one");
}

void TrainingError::meet(const DenseMatrix& U) {
    runs_.clear();
    const Index n = U.rows(), p = U.cols(), columns = method_.integrator ? method_.grid.steps + 1 : 1;
    const Eigen::HouseholderQR<DenseMatrix> qr(U);
    R_ = qr.matrixQR().topRows(p).triangularView<Eigen::Upper>();
    const DenseMatrix Q = qr.householderQ() * DenseMatrix::Identity(n, p);
    ContactWorkspace workspace(contact_.full);
    const Index m = family_->at(samples_.front()).constraints();
    const auto reduced = reduce(family_, {U, DenseMatrix(m, 0)});
    for (const Parameter& gamma : samples_) {
        const ContactProblem full = family_->at(gamma);
        if (runs_.empty()) B_U_ = full.B.times(U);
        Run& run = runs_.emplace_back(Run{reduced->at(gamma), full.c, DenseMatrix::Zero(p, columns)});
        const std::vector<Observer> record{[&](const State& state, const StepReport&) {
            run.best.col(state.step).noalias() = Q.transpose() * state.u();
            run.squared_norm += state.u().squaredNorm();
            return Flow::proceed;
        }};
        const MarchReport march = run_by(method_, full, workspace, record);
        if (march.outcome != Outcome::converged)
            throw NumericalError("TrainingError: the full run of a sample ended with " +
                                 std::string(to_string(march.outcome)));
    }
    U_ = U;
}

double TrainingError::operator()(const DenseMatrix& U, const std::vector<Index>& rows) {
    if (runs_.empty() || U.rows() != U_.rows() || U.cols() != U_.cols() || U != U_) meet(U);
    const Matrix B{DenseMatrix(B_U_(rows, Eigen::all))};
    ContactWorkspace workspace(contact_.reduced);
    double sum = 0;
    for (const Run& run : runs_) {
        ContactProblem problem = run.reduced;
        problem.B = B;
        problem.c = run.c;
        problem.c.modes = run.c.modes(rows, Eigen::all);
        double distance = 0;
        const std::vector<Observer> compare{[&](const State& state, const StepReport&) {
            distance += (R_ * state.u() - run.best.col(state.step)).squaredNorm();
            return Flow::proceed;
        }};
        if (run_by(method_, problem, workspace, compare).outcome != Outcome::converged) return infinity;
        sum += distance > 0 ? distance / run.squared_norm : 0;
    }
    return sum;
}

}  // namespace tact
