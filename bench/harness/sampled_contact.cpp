#include "sampled_contact.hpp"

#include <algorithm>

namespace tact::bench {

struct SampledContact::Log {
    std::vector<long> numbers;
    std::vector<SampledSolve>& samples;
    long solves = 0;
};

class SampledContact::Prepared final : public PreparedContact {
public:
    Prepared(std::unique_ptr<PreparedContact> inner, const Matrix& A, const Matrix& B, std::shared_ptr<Log> log)
        : inner_(std::move(inner)), A_(A), B_(B), log_(std::move(log)) {}

    ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
        const bool wanted = std::binary_search(log_->numbers.begin(), log_->numbers.end(), log_->solves++);
        if (!wanted) return inner_->solve(b, c, point);
        SampledSolve sample{A_, B_, b, c, point.u, point.lambda, {}};
        const ContactReport report = inner_->solve(b, c, point);
        sample.solution = point.u;
        log_->samples.push_back(std::move(sample));
        return report;
    }
    bool reads_guess() const override { return inner_->reads_guess(); }

private:
    std::unique_ptr<PreparedContact> inner_;
    Matrix A_, B_;
    std::shared_ptr<Log> log_;
};

SampledContact::SampledContact(std::shared_ptr<const ContactSolver> inner, std::vector<long> numbers,
                               std::vector<SampledSolve>& samples)
    : inner_(std::move(inner)), log_(std::make_shared<Log>(Log{std::move(numbers), samples})) {}

std::unique_ptr<PreparedContact> SampledContact::prepare(const Matrix& A, const Matrix& B) const {
    return std::make_unique<Prepared>(inner_->prepare(A, B), A, B, log_);
}

std::vector<long> spread(long count, long total) {
    count = std::min(count, total);
    std::vector<long> numbers;
    for (long k = 0; k < count; ++k) numbers.push_back((2 * k + 1) * total / (2 * count));
    return numbers;
}

}  // namespace tact::bench
