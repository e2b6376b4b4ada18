// libFuzzer: bytes become (A, B, b, c) with up to 8 unknowns and rows; every strategy must survive and tell the truth.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <optional>
#include <sstream>

#include "../../lib/errors.hpp"
#include "../laws/judge.hpp"
#include "../laws/strategies.hpp"

namespace tact::laws {
namespace {

/// Reads the input byte by byte; zeros after its end.
class Bytes {
public:
    Bytes(const std::uint8_t* data, std::size_t size) : next_(data), end_(data + size) {}
    unsigned next() { return next_ == end_ ? 0 : *next_++; }
    bool empty() const { return next_ == end_; }

    /// Mostly small integers and fractions, so that ties, dependence and degeneracy come often; sometimes anything.
    double number() {
        using Limits = std::numeric_limits<double>;
        const unsigned byte = next();
        if (byte < 192) return (static_cast<double>(byte) - 96) / 8;
        if (byte < 224) return std::ldexp(1.0, static_cast<int>(byte) - 208);
        constexpr double odd[] = {1e-12, -1e-12, 1e12,   -1e12,  1e20, -1e20,
                                  1e-20, 1e100,  -1e100, 1e-100, 0.1,  1.0 / 3};
        if (byte < 236) return odd[byte - 224];
        switch (byte) {
            case 236: return Limits::infinity();
            case 237: return -Limits::infinity();
            case 238: return Limits::quiet_NaN();
            case 239: return Limits::denorm_min();
            case 240: return Limits::min();
            case 241: return Limits::max();
            case 242: return -Limits::max();
            case 243: return Limits::epsilon();
            case 244: return 1 + Limits::epsilon();
            case 245: return -0.0;
            default: {
                const double exponent = static_cast<double>(static_cast<int>(next()) - 128) / 8;
                return (byte % 2 ? -1 : 1) * std::pow(10, exponent);
            }
        }
    }

private:
    const std::uint8_t *next_, *end_;
};

struct Drawn {
    QuadraticProgram qp;
    Vector guess;
    bool as_sparse, definite;
};

DenseMatrix draw_stiffness(Bytes& bytes, Index n, unsigned kind) {
    DenseMatrix G = DenseMatrix::Zero(n, n);
    if (kind == 4) {
        for (Index i = 0; i < n; ++i) G(i, i) = bytes.number();
        return G;
    }
    for (Index j = 0; j < n; ++j)
        for (Index i = 0; i < n; ++i) {
            if (kind == 1 && i < j) continue;
            G(i, j) = bytes.number();
        }
    if (kind == 0) return G;
    if (kind == 1) return G.selfadjointView<Eigen::Lower>();
    DenseMatrix A = DenseMatrix::Zero(n, n);
    for (Index i = 0; i < n; ++i)
        for (Index j = 0; j < n; ++j)
            for (Index k = 0; k < n; ++k) A(i, j) += G(k, i) * G(k, j);
    if (kind >= 3) A.diagonal().array() += 1;
    if (kind >= 6)
        for (Index i = 0; i + 1 < n; ++i) {
            A(i, i + 1) += 2;
            A(i + 1, i) -= 2;
        }
    return A;
}

DenseMatrix draw_rows(Bytes& bytes, Index m, Index n, unsigned kind) {
    DenseMatrix B = DenseMatrix::Zero(m, n);
    if (n == 0) return B;
    for (Index i = 0; i < m; ++i) {
        if (kind == 0) {
            B(i, bytes.next() % n) = bytes.number();
        } else if (kind == 1) {
            const Index j = 2 * i % n;
            B(i, j) = 1;
            B(i, (j + 1) % n) = -1;
        } else {
            for (Index j = 0; j < n; ++j) B(i, j) = bytes.number();
        }
    }
    if (kind == 3)  // equalities
        for (Index i = 0; i + 1 < m; i += 2) B.row(i + 1) = -B.row(i);
    return B;
}

Drawn draw(Bytes& bytes) {
    Drawn d;
    const Index n = bytes.next() % 9, m = bytes.next() % 9;
    const unsigned kinds = bytes.next();
    const unsigned stiffness = kinds % 8, rows = kinds / 8 % 4;
    d.as_sparse = kinds / 32 % 2;
    d.qp.A = draw_stiffness(bytes, n, stiffness);
    d.qp.B = draw_rows(bytes, m, n, rows);
    d.qp.b.resize(n);
    for (double& x : d.qp.b) x = bytes.number();
    d.qp.c.resize(m);
    for (double& x : d.qp.c) x = bytes.number();
    if (rows == 3 && kinds / 64 % 2)
        for (Index i = 0; i + 1 < m; i += 2) d.qp.c[i + 1] = -d.qp.c[i];
    d.guess.setZero(m);
    if (kinds / 128)
        for (double& x : d.guess) x = static_cast<double>(bytes.next() % 3);
    const auto tame = [](const auto& x) {
        return (x.array() == 0 || (x.array().abs() >= 1e-2 && x.array().abs() <= 1e5)).all();
    };
    d.definite = stiffness >= 3 && stiffness != 4 && tame(d.qp.A) && tame(d.qp.B) && tame(d.qp.b) && tame(d.qp.c);
    return d;
}

[[noreturn]] void fail(const char* name, const std::string& why, const Drawn& d, const Solved* s) {
    const Eigen::IOFormat exact(17);
    std::fprintf(stderr, "%s: %s\n", name, why.c_str());
    std::ostringstream text;
    text << (d.as_sparse ? "sparse" : "dense") << "\nA\n" << d.qp.A.format(exact) << "\nB\n" << d.qp.B.format(exact);
    text << "\nb " << d.qp.b.transpose().format(exact) << "\nc " << d.qp.c.transpose().format(exact);
    text << "\nguess " << d.guess.transpose();
    if (s) {
        text << "\nu " << s->u.transpose().format(exact) << "\nlambda " << s->lambda.transpose().format(exact);
        text << "\n" << to_string(s->report.outcome) << " by " << s->report.strategy << ", " << s->report.fallback;
        text << " KKT " << s->report.kkt.largest();
    }
    std::fprintf(stderr, "%s\n", text.str().c_str());
    std::abort();
}

void check(Drawn d) {
    const auto matrix = [&](const DenseMatrix& M) { return d.as_sparse ? Matrix(Matrix(M).to_sparse()) : Matrix(M); };
    const Matrix A = matrix(d.qp.A), B = matrix(d.qp.B);
    d.qp.A = A.to_dense();  // without subnormal numbers
    d.qp.B = B.to_dense();
    const bool finite =
        d.qp.A.allFinite() && d.qp.B.allFinite() && d.qp.b.allFinite() && (d.qp.c.array() < infinity).all();
    const Vector free_size = finite && d.qp.A.rows() > 0 ? size_of_free_solution(d.qp) : Vector(d.qp.A.rows());
    std::optional<Vector> first;
    for (const Strategy& strategy : strategies()) {
        Solved s;
        try {
            s = solve(*strategy.solver, A, B, d.qp.b, d.qp.c, d.guess);
        } catch (const InputError&) {
            continue;
        } catch (const NumericalError&) {
            continue;
        }
        const bool converged = s.report.outcome == Outcome::converged;
        if (!finite && converged) fail(strategy.name, "converged on data that are not finite", d, &s);
        if (!finite) continue;
        // What works on gaps of the free solution has its rounding; the chooser goes on to what has not.
        const Vector noise = (std::string(strategy.name) == "AutomaticContact" ? 1e-13 : 1e-12) * free_size;
        const std::string why = fault(d.qp, s.report, s.u, s.lambda, noise);
        if (!why.empty()) fail(strategy.name, why, d, &s);
        if (!converged && (s.lambda != d.guess || s.u != Vector::Zero(s.u.size())))
            fail(strategy.name, "a failed solve has moved the point", d, &s);
        if (!d.definite) continue;
        if (!converged && s.report.outcome != Outcome::infeasible && std::string(strategy.name) == "AutomaticContact")
            fail(strategy.name, "no answer to a tame problem", d, &s);
        if (!converged) continue;
        if (first && (*first - s.u).norm() > 1e-5 * (1 + s.u.norm()))
            fail(strategy.name, "another answer than the strategies before", d, &s);
        first = s.u;
    }
}

}  // namespace
}  // namespace tact::laws

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    tact::laws::Bytes bytes(data, size);
    tact::laws::check(tact::laws::draw(bytes));
    return 0;
}
