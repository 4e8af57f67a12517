#pragma once
// What is baked into and written to a file: shells, the voxel cube, a prefiltered cube map or spherical harmonics,
// alike to who bakes them.
#include "reflection/maps/make_baker.h"
#include "reflection/maps/map_plan.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

namespace kokage {

class BakedMap {
  public:
    virtual ~BakedMap() = default;
    /// What a baker has to be made for; may be empty (a cube map of the image alone, harmonics).
    virtual const TexelLayout& layout() const = 0;
    virtual const MapPlan& plan() const = 0;
    std::uint64_t bytes() const { return plan().bytes; } ///< of all texels in their format
    /// Fills the texels. `baker` was made for layout(); null if that is empty.
    virtual void bake(const Environment& surroundings, Baker* baker, WorkReport& report,
                      Progress& progress = silent_progress()) = 0;
    /// Copies what the file needs: the function that is returned writes it, whole or not at all, while the map may be
    /// baked anew. The ending of `path` says as what. `made_from`: a line about the surroundings, kept where the file
    /// has a place for it. Adds a warning to the report for texels that the format can't hold. Both throw InputError.
    virtual std::function<void()> packed(const std::filesystem::path& path, const std::string& made_from,
                                         WorkReport& report) const = 0;
    void write(const std::filesystem::path& path, const std::string& made_from, WorkReport& report) const {
        packed(path, made_from, report)();
    }
};

/// Takes the memory of plan_map().bytes and of the layout. Throws InputError for settings that make no map.
std::unique_ptr<BakedMap> make_map(const MapSettings& settings);

} // namespace kokage
