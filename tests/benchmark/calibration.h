#pragma once

namespace kokage {

/// CPU seconds of a fixed loop (hashing, square roots and scattered reads of 4 MiB), the best of three: tells how this
/// machine compares with another. About 0.16 s on a Xeon core with AVX-512.
double calibration_seconds();

} // namespace kokage
