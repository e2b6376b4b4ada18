#include "colour_sor.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "../../lib/algebra/empty_rows.hpp"
#include "../../lib/sparse/lanczos.hpp"
#include "../dense/acceptance.hpp"
#include "../prepare/matrix_facts.hpp"
#include "../prepare/rows.hpp"
#include "colour_sweeps.hpp"

namespace tact {
namespace {

using Doubles = SlicedRows<double>;
using Part = Doubles::Lanes::Part;
constexpr int lanes = Doubles::lanes;
constexpr int part_lanes = Doubles::Lanes::part_lanes;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

Part load(const double* x) { return Doubles::load_part(x); }
void store(double* x, const Part& v) { std::memcpy(x, &v, sizeof(v)); }
void raise(Part& largest, const Part& x) {
    const Part size = x > -x ? x : -x;
    largest = size > largest ? size : largest;
}
double largest_of(const Part& x) {
    double largest = 0;
    for (int l = 0; l < part_lanes; ++l) largest = std::max(largest, x[l]);
    return largest;
}

/// The halves of a slice in single precision. Put together and taken apart in registers: through memory, a load would
/// wait for two stores.
typedef float Half __attribute__((vector_size(sizeof(float) * part_lanes)));  // NOLINT: `using` takes no attribute
static_assert(Doubles::Lanes::parts == 2);
struct Halves {
    Half half[2];
    Places::Slice slice() const {
        return __builtin_shufflevector(half[0], half[1], 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    }
    void take(const Places::Slice& s) {
        half[0] = __builtin_shufflevector(s, s, 0, 1, 2, 3, 4, 5, 6, 7);
        half[1] = __builtin_shufflevector(s, s, 8, 9, 10, 11, 12, 13, 14, 15);
    }
};

Part to_double(const float* x) {
    Half half;
    std::memcpy(&half, x, sizeof(half));
    return __builtin_convertvector(half, Part);
}

/// Young's formula, exact for two colours; with more it is a good guess that converges all the same.
double relaxation(double radius) {
    const double r = std::min(std::max(radius, 0.0), 0.999999);
    return 2 / (1 + std::sqrt(1 - r * r));
}

/// 1 - the least eigenvalue of A scaled to unit diagonal: of the bounds that one pass gives, where sweeps relaxed by
/// either gain nearly the same, else by Lanczos' method.
double jacobi_radius(const Matrix& A) {
    const MatrixFacts facts = matrix_facts(A);
    const double most = 1 - 2 / (1 + facts.condition_below), least = 1 - 1 / facts.condition_above;
    // A sweep multiplies errors by omega - 1. Too large an omega costs less than too small a one.
    constexpr double nearly = 0.95;
    if (std::log(relaxation(most) - 1) <= nearly * std::log(relaxation(least) - 1)) return most;
    return 1 - scaled_spectrum(A).smallest;
}

class PreparedSor final : public PreparedContact {
public:
    PreparedSor(const Matrix& A, const Matrix& B) : PreparedSor(A, B, compressed_columns(A.to_sparse())) {}

    bool reads_guess() const override { return true; }

    ContactReport solve(const ConstVectorRef& b, const ConstVectorRef& c, ContactPoint point) override {
        ContactReport report;
        report.strategy = "colour SOR";
        read(b, c, point.u);
        double before = infinity;
        for (int stalled = 0;;) {
            const double share = from_above_ ? find_defect<true>() : find_defect<false>();
            if (share <= accuracy) break;
            // Twice in turn: rounding stops the descent, or nothing does; the certificate tells which. Once: a correction
            // that has put unknowns on their bounds or taken them off.
            stalled = share <= 0.25 * before ? 0 : stalled + 1;
            if (stalled == 2) break;
            if (report.iterations >= sweep_limit) {
                report.outcome = Outcome::iteration_limit;
                return report;
            }
            before = share;
            const double goal = std::max(gain, 8 * accuracy / share);
            report.iterations += from_above_ ? correct<true>(goal) : correct<false>(goal);
        }
        accept_.certify(report, b, c, answer(), multipliers(c, point.lambda), acceptable, 0, point);
        return report;
    }

private:
    static constexpr double accuracy = 5e-13;
    static constexpr double acceptable = 1e-10;
    static constexpr int sweep_limit = 2000;
    /// What single precision gains on a defect before its rounding shows.
    static constexpr double gain = 1e-5;
    static constexpr int phase_limit = 500;

    PreparedSor(const Matrix& A, const Matrix& B, CompressedRows entries)
        : accept_(A, B), n_(A.rows()), sweeps_(entries) {
        const Index padded = (n_ + lanes - 1) / lanes * lanes;
        rows_ = Doubles(static_cast<int>(padded), entries.longest_row(), [&](int i, const auto& add) {
            if (i >= entries.rows) return;
            for (int k = entries.begin(i); k < entries.end(i); ++k) add(entries.column_at(k), entries.value_at(k));
        });
        for (Padded<double>* v : {&u_, &b_, &force_}) v->resize(padded);
        inverse_.resize(padded);
        measure_.resize(padded);
        const auto diagonal = diagonal_of(entries);
        const double stiffest = *std::max_element(diagonal.begin(), diagonal.end());
        for (Index i = 0; i < n_; ++i) {
            inverse_[i] = static_cast<float>(1 / diagonal[at(i)]);
            measure_[i] = static_cast<float>(std::sqrt(stiffest / diagonal[at(i)]));
        }
        lower_.resize(padded, -infinity);
        upper_.resize(padded, infinity);
        read_rows(ConstraintRows(B));
        lambda_.resize(B.rows());
        omega_ = static_cast<float>(relaxation(jacobi_radius(A)));
    }

    void read_rows(const ConstraintRows& rows) {
        shared_ = !rows.disjoint();
        identity_ = rows.rows() == n_;
        for (Index i = 0; i < rows.rows(); ++i) {
            unknown_.push_back(rows.columns(i)[0]);
            weight_.push_back(rows.weights(i)[0]);
            from_above_ |= weight_.back() < 0;
            identity_ &= unknown_.back() == i && weight_.back() == 1;
        }
    }

    /// Takes the problem over; u starts within its bounds.
    void read(const ConstVectorRef& b, const ConstVectorRef& c, const ConstVectorRef& guess) {
        // Operands that fill whole slices are read where they are.
        const bool in_place = n_ % lanes == 0;
        const auto padded_out = [&](const ConstVectorRef& from, Padded<double>& copy) {
            if (in_place) return from.data();
            std::copy(from.begin(), from.end(), copy.data());
            return static_cast<const double*>(copy.data());
        };
        load_ = padded_out(b, b_);
        low_ = in_place && identity_ ? c.data() : lower_.data();
        if (low_ != c.data()) set_bounds(c);
        const double* start = padded_out(guess, u_);
        Part size = {};
        for (Index i = 0; i < padded(); i += part_lanes) {
            Part u = load(start + i);
            raise(size, u);
            const Part low = load(low_ + i);
            u = u > low ? u : low;
            if (from_above_) {
                const Part high = load(upper_.data() + i);
                u = u < high ? u : high;
            }
            store(u_.data() + i, u);
            raise(size, u);
            // A guess may be far smaller than what the load asks for, which single precision must hold.
            raise(size, load(load_ + i) * to_double(inverse_.data() + i));
        }
        unit_ = largest_of(size);
        if (!(unit_ > underflow)) unit_ = 1;
    }

    void set_bounds(const ConstVectorRef& c) {
        std::fill_n(lower_.data(), n_, -infinity);
        if (from_above_) std::fill_n(upper_.data(), n_, infinity);
        for (std::size_t i = 0; i < unknown_.size(); ++i) {
            const double bound = bound_of(i, c);
            if (weight_[i] > 0)
                lower_[unknown_[i]] = std::max(lower_[unknown_[i]], bound);
            else
                upper_[unknown_[i]] = std::min(upper_[unknown_[i]], bound);
        }
    }

    double bound_of(std::size_t row, const ConstVectorRef& c) const {
        return c[static_cast<Index>(row)] / weight_[row];
    }

    /// force_ = A u - b where a bound holds that against it, and what the sweeps take of b - A u: it over the diagonal, and
    /// the distances to the bounds, both in units of unit_.
    /// Answers the defect where no bound holds it over A u, max norms: the larger share of the caller's unknowns and those of
    /// unit stiffness.
    template <bool from_above> double find_defect() {
        const Doubles::Reader rows = rows_.reader();
        const Places& places = sweeps_.places();
        const double *const u = u_.data(), *const b = load_, *const low = low_, *const high = upper_.data();
        const float *const inverse = inverse_.data(), *const measure = measure_.data();
        double* const held_force = force_.data();
        float *const to_r = sweeps_.r.data(), *const to_lower = sweeps_.lower.data();
        const Part zero = {}, scale = 1 / unit_ - zero;
        auto holding = zero > zero;
        Part largest_residual = {}, largest_force = {}, scaled_residual = {}, scaled_force = {};
        for (int s = 0, slices = rows_.slices(); s < slices; ++s) {
            const Index first = Index{s} * lanes;
            Doubles::Lanes product;
            rows.multiply_slice(s, u, product);
            Halves r, lower, upper;
            for (int part = 0; part < Doubles::Lanes::parts; ++part) {
                const Index i = first + part * part_lanes;
                const Part here = load(u + i), below = load(low + i) - here;
                const Part residual = load(b + i) - product.part[part];
                auto held = (below == zero) & (residual < zero);
                r.half[part] = __builtin_convertvector(residual * scale, Half);
                lower.half[part] = __builtin_convertvector(below * scale, Half);
                if constexpr (from_above) {
                    const Part above = load(high + i) - here;
                    held |= (above == zero) & (residual > zero);
                    upper.half[part] = __builtin_convertvector(above * scale, Half);
                }
                holding |= held;
                store(held_force + i, held ? -residual : zero);
                const Part unit = to_double(measure + i);
                const Part free_residual = held ? zero : residual;
                raise(largest_residual, free_residual);
                raise(largest_force, product.part[part]);
                raise(scaled_residual, free_residual * unit);
                raise(scaled_force, product.part[part] * unit);
            }
            places.write(s, r.slice() * SlicedRows<float>::load_part(inverse + first), to_r);
            places.write(s, lower.slice(), to_lower);
            if constexpr (from_above) places.write(s, upper.slice(), sweeps_.upper.data());
        }
        holds_ = false;
        for (int l = 0; l < part_lanes; ++l) holds_ |= holding[l] != 0;
        const auto share = [](const Part& part, const Part& whole) {
            const double numerator = largest_of(part);
            return numerator == 0 ? 0 : numerator / std::max(largest_of(whole), underflow);
        };
        return std::max(share(largest_residual, largest_force), share(scaled_residual, scaled_force));
    }

    /// Sweeps until the changes have shrunk to `goal` of the first, then u takes the correction; it lies exactly on a
    /// bound that the correction has reached. Answers the number of sweeps.
    template <bool from_above> int correct(double goal) {
        sweeps_.start_from_zero();
        const float first = sweeps_.sweep<from_above>(omega_);
        int done = 1;
        for (float change = first; done < phase_limit && change > static_cast<float>(goal) * first; ++done)
            change = sweeps_.sweep<from_above>(omega_);
        const Places& places = sweeps_.places();
        const double *const low = low_, *const high = upper_.data();
        const float* const d = sweeps_.d.data();
        double* const u = u_.data();
        // The sweeps' bound is the rounded distance: half a unit of its last place is no gap.
        const Part scale = unit_ - Part{}, nearly = (1 - 1e-7) - Part{};
        for (int s = 0, slices = rows_.slices(); s < slices; ++s) {
            Places::Slice slice;
            places.read(s, d, slice);
            Halves change;
            change.take(slice);
            for (int part = 0; part < Doubles::Lanes::parts; ++part) {
                const Index i = Index{s} * lanes + part * part_lanes;
                const Part here = load(u + i), bound = load(low + i);
                const Part step = __builtin_convertvector(change.half[part], Part) * scale;
                Part next = step <= (bound - here) * nearly ? bound : here + step;
                if constexpr (from_above) {
                    const Part above = load(high + i);
                    next = step >= (above - here) * nearly ? above : next;
                }
                store(u + i, next);
            }
        }
        return done;
    }

    /// lambda_i = force at the unknown, over the weight, where the bound of row i is the one it lies on.
    /// Where there is none the guess is the answer, if it says so: one vector less to read.
    Eigen::Map<const Vector> multipliers(const ConstVectorRef& c, const ConstVectorRef& guess) {
        if (!holds_ && guess.lpNorm<1>() == 0) return {guess.data(), guess.size()};
        if (identity_) return {force_.data(), n_};
        lambda_.setZero();
        if (shared_) taken_.assign(at(n_), 0);
        for (std::size_t i = 0; i < unknown_.size(); ++i) {
            const Index k = unknown_[i];
            if (u_[k] != bound_of(i, c) || (shared_ && taken_[at(k)])) continue;
            const double force = force_[k] / weight_[i];
            if (force > 0) {
                if (shared_) taken_[at(k)] = 1;
                lambda_[static_cast<Index>(i)] = force;
            }
        }
        return {lambda_.data(), lambda_.size()};
    }

    Eigen::Map<const Vector> answer() { return {u_.data(), n_}; }

    Index padded() const { return Index{rows_.slices()} * lanes; }

    Acceptance accept_;
    Index n_;
    ColourSweeps sweeps_;
    Doubles rows_;
    std::vector<int> unknown_;
    std::vector<double> weight_;
    bool from_above_ = false;  // there are upper bounds
    bool identity_ = false;    // B
    bool holds_ = false;       // a bound carries a force
    bool shared_ = false;      // several rows on one unknown: the force goes to one of them
    std::vector<char> taken_;
    float omega_ = 1;
    double unit_ = 1;
    const double *load_ = nullptr, *low_ = nullptr;
    Padded<double> u_, b_, force_, lower_, upper_;
    Padded<float> inverse_;  // of the diagonal
    Padded<float> measure_;  // sqrt(max_j A_jj / A_ii): forces in unknowns of unit stiffness
    Vector lambda_;
};

}  // namespace

std::unique_ptr<PreparedContact> ColourSor::prepare(const Matrix& A, const Matrix& B) const {
    check_contact_matrices("ColourSor", A, B);
    if (has_empty_rows(B)) return prepare_without_empty_rows(*this, A, B);
    if (!A.is_symmetric()) throw InputError("ColourSor: A is " + A.shape() + " and not symmetric");
    if (!(A.main_diagonal().array() > 0).all())
        throw InputError("ColourSor: A has a diagonal entry <= 0, expected positive definite");
    if (!ConstraintRows(B).bounds())
        throw InputError("ColourSor: B is " + B.shape() + " with a row of no or several entries, expected one a row");
    return std::make_unique<PreparedSor>(A, B);
}

}  // namespace tact
