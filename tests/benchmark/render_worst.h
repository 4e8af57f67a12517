#pragma once
// Where pictures are worst, and why, told from their figures.
#include "tests/benchmark/render_record.h"

#include <string>
#include <vector>

namespace kokage {

/// A paragraph for each scene, of its last fast record whose errors are split.
std::string worst_text(const std::vector<PictureRecord>& records);

} // namespace kokage
