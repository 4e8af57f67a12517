#pragma once
// Video: a map for every image of a sequence, with everything that does not depend on the light made once.
#include "common/environment/load_environment.h"
#include "reflection/maps/baked_map.h"
#include "reflection/maps/image_sequence.h"

#include <filesystem>
#include <string>
#include <vector>

namespace kokage {

/// Frames of a video need not be as exact as a still map: at most 0.03/255 at 64³, a quarter less time.
inline constexpr double kVideoTolerance = 3e-4;

struct SequenceSettings {
    std::string output; ///< a pattern (image_sequence.h); its folder is made if it is missing
    BakerSettings baker{.tolerance = kVideoTolerance};
    EnvironmentLoading loading{};       ///< `split` is not looked at: bakers take images whole
    std::vector<DistantLight> lights{}; ///< added to every frame
    bool stop_at_broken = false;        ///< else broken frames are left out, and named
    /// What a finished frame's file depends on, as JSON: compared before a run goes on.
    std::string identity = "{}";
};

struct BrokenFrame {
    std::uint64_t number = 0;
    std::string why; ///< begins with the file's name
};

struct SequenceResult {
    std::uint64_t frames = 0, baked = 0, kept = 0, broken = 0; ///< kept: finished by an earlier run
    std::vector<BrokenFrame> first_broken;                     ///< twenty at most
    double wall_seconds = 0;                                   ///< of all, from the first frame to the last
    double setup_wall_seconds = 0, setup_cpu_seconds = 0;      ///< what was made once, within wall_seconds
    /// Of the baked frames, all threads; set-up is not among them. Reading and writing: of the threads that do it;
    /// baking: the rest.
    double reading_cpu_seconds = 0, baking_cpu_seconds = 0, writing_cpu_seconds = 0;

    double frames_per_second() const; ///< from file to file, after set-up; 0 if none was baked
};

/// The journal of a sequence, beside its maps: "maps/frame_%04d.exr" -> "maps/frame_journal.jsonl". Its first line
/// holds the identity, every further one a frame: {"frame", "input", "input_bytes", "input_time", "file", "bytes"}, or
/// {"frame", "input", "broken"}.
std::filesystem::path journal_of(const std::string& output_pattern);

/// Where the map of an earlier run is put when its frame's image has become broken: "maps/07.exr.outdated".
std::filesystem::path outdated_name(const std::filesystem::path& map);

/// Bakes frame after frame into `map` and writes each, whole or not at all, then its line in the journal. While a frame
/// is baked, the next ones are read and the one before is written: four frames are under way at most (with one thread,
/// one), so memory is that of a map, four images and files (and 40 bytes a frame of the journal).
///
/// A frame that the journal lists, whose file is as long and whose image is as long and old as it says, is kept: a run
/// that was stopped goes on where it was. An image that changed after it was read is baked again by the next run.
///
/// An image that can't be read, or is not as large as the first one that could be, is broken: left out and named, or
/// the end (InputError), once all frames before it are written. A map of it that an earlier run wrote is of another
/// image: it is set aside (outdated_name), and taken back if that image comes back.
///
/// The report gets the stages' sums; their CPU time within baking is told in proportion, as files are read and written
/// beside them. Throws InputError for a journal of another identity, Stopped.
SequenceResult bake_sequence(const std::vector<SequenceImage>& images, const SequenceSettings& settings, BakedMap& map,
                             WorkReport& report, Progress& progress = silent_progress());

} // namespace kokage
