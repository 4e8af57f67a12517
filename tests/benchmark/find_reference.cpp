#include "tests/benchmark/find_reference.h"
#include "common/services/random.h"
#include "foliage/path_traced.h"

namespace kokage {

namespace {

void add_to(std::vector<glm::dvec3>& sums, const std::vector<glm::vec3>& chunk) {
    sums.resize(chunk.size(), glm::dvec3(0.0));
    for (std::size_t i = 0; i < chunk.size(); ++i)
        sums[i] += glm::dvec3(chunk[i]);
}

std::optional<Reference> load_if_of(const std::filesystem::path& path, std::uint64_t hash) {
    std::optional<Reference> reference = load_reference(path);
    if (reference && reference->scene_hash != hash)
        reference.reset();
    return reference;
}

/// The better of the references in the two folders.
std::optional<Reference> find_with_hash(const BenchSceneName& name, std::uint64_t hash,
                                        const ReferenceOptions& options) {
    std::optional<Reference> best;
    for (const auto& folder : {options.stored_folder, options.cache_folder}) {
        std::optional<Reference> found = load_if_of(folder / reference_file_name(name), hash);
        if (found && (!best || found->paths_per_side > best->paths_per_side))
            best = std::move(found);
    }
    return best;
}

} // namespace

std::filesystem::path reference_file_name(const BenchSceneName& name) {
    return to_string(name) + ".reference";
}

std::optional<Reference> find_reference(const BenchScene& scene, const ReferenceOptions& options) {
    return find_with_hash(scene.name, scene_hash(scene), options);
}

Reference find_or_make_reference(const BenchScene& scene, const ReferenceOptions& options, Progress& progress) {
    const std::uint64_t hash = scene_hash(scene);
    std::optional<Reference> found = find_with_hash(scene.name, hash, options);
    if (found && found->paths_per_side >= options.paths_per_side)
        return *found;

    std::filesystem::create_directories(options.cache_folder);
    const auto finished = options.cache_folder / reference_file_name(scene.name);
    const auto unfinished = options.cache_folder / (to_string(scene.name) + ".sums");
    ReferenceSums sums = load_sums(unfinished, hash, options.paths_per_chunk)
                             .value_or(ReferenceSums{hash, options.paths_per_chunk, 0, {}});
    while (2 * sums.chunks * options.paths_per_chunk < options.paths_per_side) {
        const auto chunk =
            path_trace_reference(scene.patches, *scene.environment, std::uint32_t(2 * options.paths_per_chunk),
                                 hash64(0x7265666572656e63ull + sums.chunks), progress);
        add_to(sums.half[0], chunk.first);
        add_to(sums.half[1], chunk.second);
        ++sums.chunks;
        progress.throw_if_stopped();
        save_sums(unfinished, sums);
    }
    Reference made = sums.reference();
    save_reference(finished, made);
    return *find_with_hash(scene.name, hash, options); // as it reads back, so that the first run and the next agree
}

} // namespace kokage
