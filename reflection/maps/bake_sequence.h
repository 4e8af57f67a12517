#pragma once
// Video: a map for every image of a sequence, with everything that does not depend on the light made once.
#include "common/environment/load_environment.h"
#include "reflection/maps/baked_map.h"
#include "reflection/maps/image_sequence.h"

#include <filesystem>
#include <string>
#include <vector>

namespace kokage {

struct SequenceSettings {
    std::string output; ///< a pattern (image_sequence.h); its folder is made if it is missing
    BakerSettings baker{};
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
    double cpu_seconds = 0, wall_seconds = 0;                  ///< of the frames that were baked, from file to file
};

/// The journal of a sequence, beside its maps: "maps/frame_%04d.exr" -> "maps/frame_journal.jsonl". Its first line
/// holds the identity, every further one a frame: {"frame", "input", "input_bytes", "input_time", "file", "bytes"}, or
/// {"frame", "input", "broken"}.
std::filesystem::path journal_of(const std::string& output_pattern);

/// Bakes frame after frame into `map` and writes each, whole or not at all, before the next one is read: memory is that
/// of one frame (and 40 bytes a frame of the journal). A frame that the journal lists, whose file is as long and whose
/// image is as old as it says, is kept: a run that was stopped goes on where it was. An image that can't be read, or is
/// not as large as the first one that could be, is broken: left out and named, or the end (InputError). The report gets
/// the stages' sums. Throws InputError for a journal of another identity, Stopped.
SequenceResult bake_sequence(const std::vector<SequenceImage>& images, const SequenceSettings& settings, BakedMap& map,
                             WorkReport& report, Progress& progress = silent_progress());

} // namespace kokage
