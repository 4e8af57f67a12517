#include "reflection/maps/bake_sequence.h"
#include "common/services/error.h"
#include "common/services/only_stops.h"
#include "common/services/stopwatch.h"
#include "reflection/maps/sequence_journal.h"

#include <algorithm>
#include <cctype>
#include <set>

namespace kokage {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMostNamed = 20;

/// Adds what a frame took to what all took: one line a stage and a kind of warning, however many frames there are.
void add_frame(WorkReport& total, const WorkReport& frame) {
    const auto place = [](auto& list, const std::string& name) -> auto& {
        const auto found =
            std::find_if(list.begin(), list.end(), [&](const auto& entry) { return entry.name == name; });
        if (found != list.end())
            return *found;
        list.push_back({});
        list.back().name = name;
        return list.back();
    };
    for (const WorkReport::Stage& stage : frame.stages) {
        WorkReport::Stage& sum = place(total.stages, stage.name);
        sum.cpu_seconds += stage.cpu_seconds;
        sum.wall_seconds += stage.wall_seconds;
    }
    for (const WorkReport::Count& count : frame.counts)
        place(total.counts, count.name).value = count.value;
    for (const WorkReport::Skip& skip : frame.skips)
        if (std::none_of(total.skips.begin(), total.skips.end(),
                         [&](const WorkReport::Skip& known) { return known.what == skip.what; }))
            total.skips.push_back(skip);
    for (const std::string& warning : frame.warnings)
        if (total.warnings.size() < kMostNamed &&
            std::find(total.warnings.begin(), total.warnings.end(), warning) == total.warnings.end())
            total.warnings.push_back(warning);
}

/// One sequence being baked: what is made by its first frame serves all.
class SequenceBake {
  public:
    SequenceBake(const SequenceSettings& settings, BakedMap& map, WorkReport& report)
        : settings_(settings), map_(map), report_(report) {}

    /// A frame of an earlier run tells the size that all have.
    void note_size(const SequenceImage& kept) {
        if (width_ == 0) {
            WorkReport ignored;
            const Environment environment = load(kept, ignored);
            width_ = environment.remainder.width;
            height_ = environment.remainder.height;
        }
    }

    /// Throws InputError if the image is broken.
    Environment load(const SequenceImage& image, WorkReport& of_frame) const {
        EnvironmentLoading loading = settings_.loading;
        loading.split = false;
        EnvironmentReport loaded;
        Environment environment = load_environment(image.file, loaded, loading);
        const Image& pixels = environment.remainder;
        if (width_ > 0 && (pixels.width != width_ || pixels.height != height_))
            throw InputError("'" + image.file.string() + "' is " + std::to_string(pixels.width) + " x " +
                             std::to_string(pixels.height) + ", not " + std::to_string(width_) + " x " +
                             std::to_string(height_) + " as the frames before it");
        environment.distant_lights = settings_.lights;
        of_frame.warnings = loaded.warnings;
        return environment;
    }

    void bake(const Environment& environment, const fs::path& output, WorkReport& of_frame, Progress& progress) {
        width_ = environment.remainder.width;
        height_ = environment.remainder.height;
        if (!prepared_) {
            prepared_ = true;
            if (map_.layout().size() > 0)
                baker_ = make_baker(map_.layout(), width_, height_, settings_.baker, report_, progress);
        }
        map_.bake(environment, baker_.get(), of_frame, progress);
        progress.throw_if_stopped();
        const Stopwatch writing;
        map_.write(output, environment.description, of_frame);
        of_frame.stages.push_back({"writing", writing.cpu(), writing.wall()});
    }

  private:
    const SequenceSettings& settings_;
    BakedMap& map_;
    WorkReport& report_;
    std::unique_ptr<Baker> baker_;
    int width_ = 0, height_ = 0;
    bool prepared_ = false;
};

/// Maps, journal and set-up must not lie where the images do.
void check_images_survive(const std::vector<SequenceImage>& images, const SequenceSettings& settings) {
    std::set<fs::path> inputs;
    for (const SequenceImage& image : images)
        inputs.insert(fs::weakly_canonical(image.file));
    const auto check = [&](const fs::path& written) {
        if (!written.empty() && inputs.contains(fs::weakly_canonical(written)))
            throw InputError("'" + written.string() +
                             "' is one of the images and would be written over; write to another folder");
    };
    for (const SequenceImage& image : images)
        check(numbered_name(settings.output, image.number));
    check(journal_of(settings.output));
    check(settings.baker.stored_setup);
}

void make_folder_of(const std::string& output) {
    const fs::path folder = fs::path(output).parent_path();
    std::error_code error;
    if (!folder.empty())
        fs::create_directories(folder, error);
    if (!folder.empty() && !fs::is_directory(folder))
        throw InputError("the folder '" + folder.string() + "' can't be made (" +
                         (error ? error.message() : "there is a file of that name") + ")");
}

} // namespace

fs::path journal_of(const std::string& output_pattern) {
    const fs::path pattern(output_pattern);
    const std::string name = pattern.filename().string();
    std::string stem = name.substr(0, name.find('%'));
    if (!stem.empty() && std::isalnum(static_cast<unsigned char>(stem.back())))
        stem += "-";
    return pattern.parent_path() / (stem + "journal.jsonl");
}

SequenceResult bake_sequence(const std::vector<SequenceImage>& images, const SequenceSettings& settings, BakedMap& map,
                             WorkReport& report, Progress& progress) {
    check_images_survive(images, settings);
    make_folder_of(settings.output);
    SequenceJournal journal(journal_of(settings.output), settings.identity);
    SequenceBake sequence(settings, map, report);
    SequenceResult result;
    result.frames = images.size();
    OnlyStops within_a_frame(progress);
    progress.begin("baking frames", images.size());
    for (const SequenceImage& image : images) {
        progress.throw_if_stopped();
        const fs::path output = numbered_name(settings.output, image.number);
        if (journal.has(image.number, image.file, output)) {
            sequence.note_size(image);
            ++result.kept;
            progress.advance(1);
            continue;
        }
        const Stopwatch watch;
        WorkReport of_frame;
        Environment environment;
        try {
            environment = sequence.load(image, of_frame);
        } catch (const InputError& error) {
            journal.add_broken(image.number, image.file, error.what());
            if (settings.stop_at_broken)
                throw InputError("frame " + std::to_string(image.number) + " is broken: " + error.what() +
                                 "; finished frames stay, and the same command goes on");
            ++result.broken;
            if (result.first_broken.size() < kMostNamed)
                result.first_broken.push_back({image.number, error.what()});
            progress.advance(1);
            continue;
        }
        of_frame.stages.push_back({"reading", watch.cpu(), watch.wall()});
        sequence.bake(environment, output, of_frame, within_a_frame);
        journal.add_finished(image.number, image.file, output);
        add_frame(report, of_frame);
        result.cpu_seconds += watch.cpu();
        result.wall_seconds += watch.wall();
        ++result.baked;
        progress.advance(1);
    }
    if (result.broken == result.frames)
        throw InputError("none of the " + std::to_string(result.frames) +
                         " images can be read: " + result.first_broken.front().why);
    return result;
}

} // namespace kokage
