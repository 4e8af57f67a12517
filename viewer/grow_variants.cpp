#include "viewer/grow_variants.h"
#include "common/services/count_text.h"
#include "common/services/error.h"
#include "common/services/only_stops.h"
#include "common/services/stopwatch.h"
#include "trees/describe.h"
#include "trees/growth.h"
#include "trees/write_tree.h"
#include "viewer/scene/values.h"
#include "viewer/stop_signal.h"
#include "viewer/write_json.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

namespace kokage {
namespace {
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::uint64_t kMostVariants = 1000000;

Json parameters_json(const GrowthParameters& parameters) {
    Json json = Json::object();
    for (const ParameterDescription& p : parameter_descriptions(parameters))
        if (p.name != "seed")
            json[p.name] = !p.choices.empty() ? Json(value_text(p))
                           : p.whole          ? Json(std::int64_t(p.value))
                                              : Json(p.value);
    return json;
}

/// What is in the folder.
class Manifest {
  public:
    Manifest(const Species& species, const fs::path& folder) : folder_(folder) {
        head_ = {{"program", "kokage " KOKAGE_VERSION},
                 {"species", species.name},
                 {"parameters", parameters_json(species.parameters)}};
        if (fs::exists(path()))
            read();
    }

    /// True if the tree of this seed is there as the manifest says.
    bool has(std::uint64_t seed) const {
        const auto found = trees_.find(seed);
        std::error_code missing;
        return found != trees_.end() &&
               fs::file_size(folder_ / found->second["file"], missing) == found->second["bytes"].get<std::uintmax_t>();
    }
    std::size_t size() const { return trees_.size(); }
    fs::path path() const { return folder_ / "manifest.json"; }

    void add(std::uint64_t seed, Json tree) {
        trees_[seed] = std::move(tree);
        Json json = head_;
        json["trees"] = Json::array();
        for (const auto& [number, entry] : trees_)
            json["trees"].push_back(entry);
        write_json(path(), json);
    }

  private:
    void read() {
        Json json;
        try {
            json = Json::parse(std::ifstream(path()));
            for (const Json& tree : json.at("trees")) {
                if (!tree.at("file").is_string() || fs::path(tree["file"]).has_parent_path())
                    throw InputError("a tree's file is no plain name");
                tree.at("bytes").get<std::uintmax_t>();
                trees_[tree.at("seed").get<std::uint64_t>()] = tree;
            }
        } catch (const std::exception& error) {
            throw InputError("'" + path().string() + "' can't be read as a manifest of grown trees (" + error.what() +
                             "); choose another folder, or remove that file");
        }
        for (const char* key : {"program", "species"})
            if (json.value(key, Json()) != head_[key])
                refuse(key, json.value(key, Json()), head_[key]);
        const Json before = json.value("parameters", Json::object());
        for (const auto& [name, value] : head_["parameters"].items())
            if (before.value(name, Json()) != value)
                refuse(name, before.value(name, Json()), value);
    }

    [[noreturn]] void refuse(const std::string& what, const Json& there, const Json& asked) const {
        throw InputError("'" + folder_.string() + "' holds other trees: their " + what + " is " + there.dump() +
                         ", not " + asked.dump() + "; choose another folder, or remove its manifest.json");
    }

    fs::path folder_;
    Json head_;
    std::map<std::uint64_t, Json> trees_;
};

/// Grows and writes one tree, and returns its entry in the manifest.
Json grow_one(GrowthParameters parameters, std::uint64_t seed, const fs::path& folder, Progress& progress) {
    parameters.seed = seed;
    const std::string file = parameters.species + "-" + std::to_string(seed) + ".glb";
    const Tree tree = grow(parameters, progress);
    progress.throw_if_stopped();
    const WritingFiles writing;
    write_tree(folder / file, tree, nullptr, {}, progress);
    const TreeDescription about = describe(tree);
    return {{"seed", seed},
            {"file", file},
            {"leaves", about.leaves},
            {"branches", tree.skeleton.branches.size()},
            {"triangles", about.triangles},
            {"height_m", about.high.y - about.low.y},
            {"width_m", std::max(about.high.x - about.low.x, about.high.z - about.low.z)},
            {"bytes", fs::file_size(folder / file)}};
}

} // namespace

SeedRange seeds_from(std::string_view text) {
    const auto wrong = [&](const char* why) {
        return InputError("--seeds: '" + std::string(text) + "' " + why +
                          "; give a first and a last seed, such as 1..20");
    };
    const std::size_t dots = text.find("..");
    if (dots == std::string_view::npos)
        throw wrong("is no range");
    const auto number = [&](std::string_view digits) {
        std::uint64_t value = 0;
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
        if (error != std::errc() || end != digits.data() + digits.size() || value > (std::uint64_t(1) << 53))
            throw wrong("is not two whole numbers");
        return value;
    };
    const SeedRange range{number(text.substr(0, dots)), number(text.substr(dots + 2))};
    if (range.first > range.last)
        throw wrong("is the wrong way round");
    if (range.last - range.first >= kMostVariants)
        throw wrong("are more than a million trees");
    return range;
}

void grow_variants(const TreeSource& source, const SeedRange& seeds, const fs::path& folder,
                   const CommandContext& context) {
    const Species species = asked_species(source);
    std::error_code error;
    fs::create_directories(folder, error);
    if (!fs::is_directory(folder))
        throw InputError("-o: the folder '" + folder.string() + "' can't be made (" +
                         (error ? error.message() : "there is a file of that name") + ")");
    Manifest manifest(species, folder);
    const Stopwatch watch;
    const std::uint64_t count = seeds.last - seeds.first + 1;
    std::uint64_t kept = 0;
    OnlyStops within_a_tree(*context.progress);
    context.progress->begin("growing " + species.name, std::size_t(count));
    try {
        for (std::uint64_t seed = seeds.first; seed <= seeds.last; ++seed) {
            context.progress->throw_if_stopped();
            if (manifest.has(seed))
                ++kept;
            else
                manifest.add(seed, grow_one(species.parameters, seed, folder, within_a_tree));
            context.progress->advance(1);
        }
    } catch (const Stopped&) {
        std::uint64_t there = 0;
        for (std::uint64_t seed = seeds.first; seed <= seeds.last; ++seed)
            there += manifest.has(seed);
        throw StoppedBetweenFiles(count_text(there) + " of " + counted(count, "tree", "trees") +
                                  (there == 1 ? " is in '" : " are in '") + folder.string() +
                                  "'; the same command goes on");
    }
    context.progress->clear();
    if (!context.quiet)
        std::printf("%s: %s grown in %s%s; listed in %s\n", folder.c_str(),
                    counted(count - kept, "tree", "trees").c_str(), duration_text(watch.wall()).c_str(),
                    kept > 0 ? (", " + count_text(kept) + " kept from before").c_str() : "", manifest.path().c_str());
}

} // namespace kokage
