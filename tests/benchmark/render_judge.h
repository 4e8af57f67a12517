#pragma once
// How far a picture is from its truth.
#include "tests/benchmark/render_record.h"
#include "tests/benchmark/render_truth.h"

namespace kokage {

/// Sets the errors of a record.
void judge(const Image& radiance, const PictureTruth& truth, PictureRecord& record);

/// Sets which part of a record's errors more samples would take away, and which would stay: two pictures that differ
/// by their seeds alone. With the squared errors of both, a and b, their mean product is the square of what both share
/// (less what the truth's own noise has in it), half the mean square of a - b the square of what is each one's own.
void split_errors(const Image& a, const Image& b, const PictureTruth& truth, PictureRecord& record);

/// Sets which light a record's bias is of, from two pictures with layers, the second path-traced on the judged pixels.
/// Its noise averages out over the many pixels of a kind.
void split_bias(const Picture& picture, const Picture& traced, const PictureTruth& truth, PictureRecord& record);

} // namespace kokage
