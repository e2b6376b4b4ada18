// Products of small bands with a few right-hand sides: what the passes of a SupernodalFactor are made of.
#pragma once

#include "../types.hpp"

namespace tact::supernodal {

// Vectors of the compiler: in a register where the processor has one so wide, else in several.
template <int entries> struct PackOf;
template <> struct PackOf<2> { typedef double type __attribute__((vector_size(16), aligned(8), may_alias)); };
template <> struct PackOf<4> { typedef double type __attribute__((vector_size(32), aligned(8), may_alias)); };
template <> struct PackOf<8> { typedef double type __attribute__((vector_size(64), aligned(8), may_alias)); };
template <int entries> using Pack = typename PackOf<entries>::type;

template <int entries> const Pack<entries>& pack(const double* x) {
    return *reinterpret_cast<const Pack<entries>*>(x);
}
template <int entries> Pack<entries>& pack(double* x) { return *reinterpret_cast<Pack<entries>*>(x); }

// One or two right-hand sides: the rows of a band are the lanes. More: the right-hand sides are.
constexpr bool rows_are_lanes(int columns) { return columns <= 2; }
constexpr Index numbers_in_sum(int columns) { return rows_are_lanes(columns) ? columns * 8 : columns; }

/// Numbers ahead of the pass, forwards or backwards, that the processor is asked to fetch: 2 kB.
constexpr Index ahead = 256;

/// w[row(i)][.] -= sums for eight (four) rows i.
template <int height, int columns, class RowAt>
void subtract_rows(const Pack<height> (&sum)[columns], double* w, RowAt row_at) {
    if constexpr (columns == 1) {
        for (int i = 0; i < height; ++i) w[row_at(i)] -= sum[0][i];
    } else {
        alignas(64) double rows[2 * height];
        if constexpr (height == 8) {
            pack<8>(rows) = __builtin_shufflevector(sum[0], sum[1], 0, 8, 1, 9, 2, 10, 3, 11);
            pack<8>(rows + 8) = __builtin_shufflevector(sum[0], sum[1], 4, 12, 5, 13, 6, 14, 7, 15);
        } else {
            pack<4>(rows) = __builtin_shufflevector(sum[0], sum[1], 0, 4, 1, 5);
            pack<4>(rows + 4) = __builtin_shufflevector(sum[0], sum[1], 2, 6, 3, 7);
        }
        for (int i = 0; i < height; ++i) pack<2>(w + row_at(i) * 2) -= pack<2>(rows + 2 * i);
    }
}

template <int height, int columns, class RowAt>
void gather_rows(const double* w, RowAt row_at, Pack<height> (&y)[columns]) {
    if constexpr (columns == 1) {
        for (int i = 0; i < height; ++i) y[0][i] = w[row_at(i)];
    } else {
        Pack<4> pairs[height / 2];
        for (int i = 0; i < height / 2; ++i)
            pairs[i] = __builtin_shufflevector(pack<2>(w + row_at(2 * i) * 2), pack<2>(w + row_at(2 * i + 1) * 2), 0,
                                               1, 2, 3);
        if constexpr (height == 8) {
            const Pack<8> low = __builtin_shufflevector(pairs[0], pairs[1], 0, 1, 2, 3, 4, 5, 6, 7);
            const Pack<8> high = __builtin_shufflevector(pairs[2], pairs[3], 0, 1, 2, 3, 4, 5, 6, 7);
            y[0] = __builtin_shufflevector(low, high, 0, 2, 4, 6, 8, 10, 12, 14);
            y[1] = __builtin_shufflevector(low, high, 1, 3, 5, 7, 9, 11, 13, 15);
        } else {
            y[0] = __builtin_shufflevector(pairs[0], pairs[1], 0, 2, 4, 6);
            y[1] = __builtin_shufflevector(pairs[0], pairs[1], 1, 3, 5, 7);
        }
    }
}

/// w[row(i)] -= sum_j U[i, j] x[j] for the rows of a band, right-hand sides interleaved (x[j][k]).
template <int height, int columns, class RowAt>
void subtract_product(const double* U, Index count, const double* x, double* w, RowAt row_at) {
    if constexpr (rows_are_lanes(columns)) {
        Pack<height> sum[columns] = {};
        for (Index j = 0; j < count; ++j) {
            __builtin_prefetch(U + j * height + ahead);
            for (int k = 0; k < columns; ++k) sum[k] += pack<height>(U + j * height) * x[j * columns + k];
        }
        subtract_rows<height, columns>(sum, w, row_at);
    } else {
        constexpr int lanes = columns < 8 ? columns : 8;
        constexpr int packs = columns / lanes;
        constexpr int rows = 8 / packs < height ? 8 / packs : height;  // that many sums fit into the registers
        for (int first = 0; first < height; first += rows) {
            Pack<lanes> sum[rows][packs] = {};
            for (Index j = 0; j < count; ++j)
                for (int p = 0; p < packs; ++p) {
                    const Pack<lanes> xj = pack<lanes>(x + j * columns + p * lanes);
                    for (int i = 0; i < rows; ++i) sum[i][p] += xj * U[j * height + first + i];
                }
            for (int i = 0; i < rows; ++i)
                for (int p = 0; p < packs; ++p) pack<lanes>(w + row_at(first + i) * columns + p * lanes) -= sum[i][p];
        }
    }
}

/// sums[j] += sum_i U[i, j] w[row(i)]; where rows are lanes the sum over i is left for later.
template <int height, int columns, class RowAt>
void add_transposed_product(const double* U, Index count, const double* w, RowAt row_at, double* sums) {
    if constexpr (rows_are_lanes(columns)) {
        Pack<height> y[columns];
        gather_rows<height, columns>(w, row_at, y);
        for (Index j = 0; j < count; ++j) {
            __builtin_prefetch(U + j * height - ahead);
            for (int k = 0; k < columns; ++k)
                pack<height>(sums + (j * columns + k) * 8) += pack<height>(U + j * height) * y[k];
        }
    } else {
        constexpr int lanes = columns < 8 ? columns : 8;
        constexpr int packs = columns / lanes;
        Pack<lanes> y[height][packs];
        for (int i = 0; i < height; ++i)
            for (int p = 0; p < packs; ++p) y[i][p] = pack<lanes>(w + row_at(i) * columns + p * lanes);
        for (Index j = 0; j < count; ++j)
            for (int p = 0; p < packs; ++p) {
                Pack<lanes> even = pack<lanes>(sums + j * columns + p * lanes), odd = {};
                for (int i = 0; i < height; i += 2) {
                    even += y[i][p] * U[j * height + i];
                    odd += y[i + 1][p] * U[j * height + i + 1];
                }
                pack<lanes>(sums + j * columns + p * lanes) = even + odd;
            }
    }
}

/// The sums over the lanes of eight packs, `stride` numbers apart.
inline void add_lanes(const double* sums, Index stride, Pack<8>& total) {
    Pack<8> a[4];
    for (int i = 0; i < 4; ++i) {
        const Pack<8> u = pack<8>(sums + 2 * i * stride), v = pack<8>(sums + (2 * i + 1) * stride);
        a[i] = __builtin_shufflevector(u, v, 0, 8, 2, 10, 4, 12, 6, 14) +
               __builtin_shufflevector(u, v, 1, 9, 3, 11, 5, 13, 7, 15);
    }
    Pack<8> b[2];
    for (int i = 0; i < 2; ++i)
        b[i] = __builtin_shufflevector(a[2 * i], a[2 * i + 1], 0, 1, 8, 9, 4, 5, 12, 13) +
               __builtin_shufflevector(a[2 * i], a[2 * i + 1], 2, 3, 10, 11, 6, 7, 14, 15);
    total = __builtin_shufflevector(b[0], b[1], 0, 1, 2, 3, 8, 9, 10, 11) +
            __builtin_shufflevector(b[0], b[1], 4, 5, 6, 7, 12, 13, 14, 15);
}

/// x := S^-1 x - sums on the rows of one diagonal block.
template <int height, int columns>
void finish_block(const double* inverse, int width, const double* sums, double* x) {
    if constexpr (rows_are_lanes(columns)) {
        Pack<height> result[columns] = {};
        for (int j = 0; j < width; ++j)
            for (int k = 0; k < columns; ++k) result[k] += pack<height>(inverse + j * height) * x[j * columns + k];
        for (int k = 0; k < columns; ++k) {
            Pack<8> total;
            add_lanes(sums + k * 8, columns * 8, total);
            for (int i = 0; i < width; ++i) x[i * columns + k] = result[k][i] - total[i];
        }
    } else {
        constexpr int lanes = columns < 8 ? columns : 8;
        for (int p = 0; p < columns; p += lanes) {
            Pack<lanes> result[height] = {};
            for (int j = 0; j < width; ++j) {
                const Pack<lanes> xj = pack<lanes>(x + j * columns + p);
                for (int i = 0; i < height; ++i) result[i] += xj * inverse[j * height + i];
            }
            for (int i = 0; i < width; ++i)
                pack<lanes>(x + i * columns + p) = result[i] - pack<lanes>(sums + i * columns + p);
        }
    }
}

}  // namespace tact::supernodal
