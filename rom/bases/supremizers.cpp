#include "supremizers.hpp"

#include <string>
#include <vector>

#include "../../lib/errors.hpp"
#include "pod.hpp"

namespace tact {

DenseMatrix supremizers(const ContactProblem& problem, const DenseMatrix& U_lambda, Index count,
                        const SupremizerOptions& options) {
    if (U_lambda.rows() != problem.constraints())
        throw InputError("supremizers: U_lambda has " + std::to_string(U_lambda.rows()) + " rows, expected " +
                         std::to_string(problem.constraints()));
    if (!options.linear) throw InputError("SupremizerOptions: linear is empty, expected a linear solver");
    Matrix A = problem.K;
    if (options.a != 0 && problem.D) A = combine(options.a, *problem.D, 1, A);
    if (options.a != 0 && problem.M) A = combine(options.a * options.a, *problem.M, 1, A);
    DenseMatrix answers = problem.B.transposed_times(U_lambda);
    if (answers.cols() == 0 || count < 1) return {problem.size(), 0};
    options.linear->factorize(A)->solve(answers);
    std::vector<Index> moved;
    for (Index j = 0; j < answers.cols(); ++j) {
        if (answers.col(j).isZero(0)) continue;
        answers.col(j).stableNormalize();
        moved.push_back(j);
    }
    answers = answers(Eigen::all, moved).eval();
    if (answers.cols() <= count) return answers;
    PodOptions leading;
    leading.rank = count;
    return pod(answers, leading).modes;
}

}  // namespace tact
