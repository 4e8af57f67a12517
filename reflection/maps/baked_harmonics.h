#pragma once
// Spherical harmonics as one of the maps that are baked and written. Inside of baked_map.h alone.
#include "reflection/maps/baked_map.h"

namespace kokage {

/// Its layout is empty: nothing is filtered. Written as .json (harmonics_file.h).
std::unique_ptr<BakedMap> make_baked_harmonics(const MapSettings& settings);

} // namespace kokage
