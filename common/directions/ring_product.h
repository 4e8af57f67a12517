#pragma once
// The product at the core of ring transforms.
#include <cstddef>

namespace kokage {

/// Six columns of values that a table is multiplied by: value c of row k stands at values[k * row + c * column].
struct RingColumns {
    const float* values;
    std::size_t row, column;
};

/// result[c * result_stride + i] = sum over k < rows of table[k * table_stride + i] x column c of row k, for i < count,
/// c < 6. `count` and the table's stride are multiples of 16. Sums run over k in order.
void ring_product(const float* table, std::size_t table_stride, std::size_t rows, std::size_t count,
                  const RingColumns& columns, float* result, std::size_t result_stride);

} // namespace kokage
