#include "colour_sweeps.hpp"

#include <algorithm>
#include <utility>

namespace tact {
namespace {

constexpr int lanes = SlicedRows<float>::lanes;

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

}  // namespace

Places::Places(std::vector<int> place) : place_(std::move(place)) {
    const auto count = static_cast<int>(place_.size());
    // The lanes that fill up the last slice go to the padding.
    while (place_.size() % lanes != 0) place_.push_back(-1 - static_cast<int>(place_.size() % lanes));
    for (int first = 0; first < count; first += lanes) {
        const auto runs = [&](int stride) {
            for (int l = stride; l < lanes; ++l)
                if (place_[at(first + l)] != place_[at(first + l - stride)] + 1) return false;
            return true;
        };
        kind_.push_back(runs(1) ? Kind::one_run : runs(2) ? Kind::two_runs : Kind::scattered);
    }
}

ColourSweeps::ColourSweeps(const CompressedRows& A) {
    const auto colour = greedy_colours(A);
    std::vector<int> count(A.rows > 0 ? at(1 + *std::max_element(colour.begin(), colour.end())) : 0, 0), next;
    for (const int k : colour) ++count[at(k)];
    int padded = 0;
    for (const int n : count) {  // each colour starts on a whole slice
        next.push_back(padded);
        padded += (n + lanes - 1) / lanes * lanes;
    }
    std::vector<int> place(at(A.rows)), unknown(at(padded), -1);
    for (int i = 0; i < A.rows; ++i) {
        place[at(i)] = next[at(colour[at(i)])]++;
        unknown[at(place[at(i)])] = i;
    }
    const auto diagonal = diagonal_of(A);
    couplings_ = SlicedRows<float>(padded, A.longest_row(), [&](int to, const auto& add) {
        const int i = unknown[at(to)];
        if (i < 0) return;
        for (int k = A.begin(i); k < A.end(i); ++k) {
            const int j = A.column_at(k);
            if (j != i) add(place[at(j)], A.value_at(k) / diagonal[at(i)]);
        }
    });
    for (Padded<float>* v : {&r, &lower, &upper, &d}) v->resize(padded);
    places_ = Places(std::move(place));
}

void ColourSweeps::start_from_zero() { std::fill_n(d.data(), couplings_.slices() * lanes, 0.0F); }

template <bool from_above> float ColourSweeps::sweep(float omega) {
    using Rows = SlicedRows<float>;
    using Part = Rows::Lanes::Part;
    const Rows::Reader rows = couplings_.reader();
    const float* const load = r.data();
    const float* const low = lower.data();
    const float* const high = upper.data();
    float* const x = d.data();
    Part change = {};
    for (int s = 0, slices = couplings_.slices(); s < slices; ++s) {
        const Index i = Index{s} * lanes;
        Rows::Lanes sum;
        rows.multiply_slice(s, x, sum);
        const Part old = Rows::load_part(x + i), bound = Rows::load_part(low + i);
        Part next = old + omega * (Rows::load_part(load + i) - sum.part[0] - old);
        next = next > bound ? next : bound;
        if constexpr (from_above) {
            const Part above = Rows::load_part(high + i);
            next = next < above ? next : above;
        }
        std::memcpy(x + i, &next, sizeof(next));
        const Part up = next - old, down = old - next;
        const Part step = up > down ? up : down;
        change = step > change ? step : change;
    }
    float largest = 0;
    for (int l = 0; l < lanes; ++l) largest = std::max(largest, change[l]);
    return largest;
}

template float ColourSweeps::sweep<false>(float);
template float ColourSweeps::sweep<true>(float);

}  // namespace tact
