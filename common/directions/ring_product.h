#pragma once
// The products at the core of ring transforms.
#include "common/directions/batch_fft.h"
#include "common/directions/ring_transform.h"

#include <cstddef>

namespace kokage {

/// Analysis. result[c * count + i] = sum over k < rows of table[k * count + i] x values[k * 6 + c], for i < count, c <
/// 6. `count` is a multiple of 16. Sums run over k in order.
void ring_analysis_product(const float* table, std::size_t rows, std::size_t count, const float* values, float* result);

/// Synthesis on 16 rings at once, for several zonal functions:
///     result[(f * 6 + c) * 16 + ring] = sum over k < rows of table[k * 16 + ring] x zonals[f][k] x coefficients[c *
///     column + k]
/// for c < 6, f < functions <= RingSynthesis::kMostGrids.
void ring_synthesis_product(const float* table, std::size_t rows, const float* coefficients, std::size_t column,
                            const float* const* zonals, std::size_t functions, float* result);

/// rows[ring][column] = (red, green, blue, 0) of element column, lane ring, for columns of them; `rings` <= 16. Each of
/// red, green, blue: elements of BatchFft::kElement floats, of which the first 16 are taken.
void interleave_rings(const float* red, const float* green, const float* blue, std::size_t columns, std::size_t rings,
                      float* const* rows);

} // namespace kokage
