#pragma once
// Cones that hold no surface, for cone step mapping: J. Dummer, Cone Step Mapping: An Iterative Ray-Heightfield
// Intersection Algorithm (2006). Private to relief.
#include "reflection/relief/height_field.h"

#include <filesystem>
#include <vector>

namespace kokage {

/// Over a cell. Dummer's cones stand on texels and are measured between texels, so that they may cut the bilinear
/// surface between; these are safe. A cone over ANY point of the cell, its tip `top` deep, holds no surface: where it
/// is e less deep, it is `ratio` e wide. Its cross-section is a diamond, width measured as |x| + |y| texels, because
/// then the bilinear surface stays out of it exactly if the texels do: along the grid's lines and so within each
/// cell the diamond's height |x| + |y| is itself bilinear (a round cone's would be above its interpolation).
struct CellCone {
    float top = 0;   ///< the least depth of the cell's corners
    float ratio = 0; ///< texels per unit of depth, > 0; kEmptyRatio: nothing is higher
};

inline constexpr float kEmptyRatio = 1e18f;

/// Exact: the widest such cones; of width x height cells, a repeated tile's obstacles across its edges included; of a
/// clamped tile the last column and row are the border's. Each cell searches a pyramid of least depths, nearest
/// first.
std::vector<CellCone> make_cone_map(const HeightField& field);

/// In a checked file (common/services/checked_file.h), to be loaded for the same field alone. Throw InputError.
void store_cone_map(const HeightField& field, const std::vector<CellCone>& cones, const std::filesystem::path& path);
std::vector<CellCone> load_cone_map(const HeightField& field, const std::filesystem::path& path);

} // namespace kokage
