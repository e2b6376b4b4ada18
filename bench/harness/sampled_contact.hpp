// Contact solves picked out of a run, so that another solver can be timed on them without a whole march.
#pragma once

#include <memory>
#include <vector>

#include "../../lib/contact_solver.hpp"

namespace tact::bench {

/// One solve of a run as it was asked: (A, B), (b, c) and the guess; and the u it was answered with.
struct SampledSolve {
    Matrix A, B;
    Vector b, c, u, lambda;
    Vector solution;
};

/// Hands every solve on to `inner` and copies those whose number, counted from 0 over all that was prepared, is in
/// `numbers` (ascending) to `samples`, which must outlive it.
class SampledContact final : public ContactSolver {
public:
    SampledContact(std::shared_ptr<const ContactSolver> inner, std::vector<long> numbers,
                   std::vector<SampledSolve>& samples);
    std::unique_ptr<PreparedContact> prepare(const Matrix& A, const Matrix& B) const override;

private:
    class Prepared;
    struct Log;
    std::shared_ptr<const ContactSolver> inner_;
    std::shared_ptr<Log> log_;
};

/// `count` numbers of 0, ..., total - 1, each in the middle of an equal part.
std::vector<long> spread(long count, long total);

}  // namespace tact::bench
