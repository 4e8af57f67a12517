#include "reflection/maps/bake_sequence.h"
#include "common/scene/image_file.h"
#include "common/services/error.h"
#include "common/services/only_stops.h"
#include "common/services/parallel.h"
#include "common/services/stopwatch.h"
#include "reflection/maps/map_file.h"
#include "reflection/maps/sequence_journal.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
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

/// One sequence being baked, frame by frame in three steps, each of which may be at another frame.
class SequenceBake {
  public:
    SequenceBake(const std::vector<SequenceImage>& images, const SequenceSettings& settings, BakedMap& map,
                 Progress& progress)
        : images_(images), settings_(settings), map_(map), progress_(progress), within_a_frame_(progress),
          journal_(journal_of(settings.output), settings.identity) {
        result_.frames = images.size();
    }

    SequenceResult run(WorkReport& report) {
        std::optional<ImageFilesOnOneThread> alone;
        if (map_.bytes() < kSmallFile && facts_of_image(images_.front().file).bytes < kSmallFile)
            alone.emplace();
        const Stopwatch watch;
        parallel_stages(
            kPlaces, [&](std::size_t place) { return read_next(frames_[place]); },
            {[&](std::size_t place) { bake(frames_[place]); }, [&](std::size_t place) { finish(frames_[place]); }});
        result_.wall_seconds = watch.wall();
        if (result_.broken == result_.frames)
            throw InputError("none of the " + std::to_string(result_.frames) +
                             " images can be read: " + result_.first_broken.front().why);
        tell_times(watch.cpu());
        report.append(work_);
        return result_;
    }

  private:
    static constexpr std::size_t kPlaces = 4;
    /// Below it, the threads of image libraries cost more than they save.
    static constexpr std::uint64_t kSmallFile = std::uint64_t(8) << 20;

    struct Frame {
        enum class State { ready, kept, broken };
        State state = State::ready;
        std::uint64_t number = 0;
        fs::path output;
        ImageFacts image;
        std::string why; ///< it is broken
        Environment environment;
        std::function<void()> write;
        WorkReport report;
    };

    bool read_next(Frame& frame) {
        if (next_ == images_.size() || ended_)
            return false;
        progress_.throw_if_stopped();
        const SequenceImage& image = images_[next_++];
        frame = {};
        frame.number = image.number;
        frame.output = numbered_name(settings_.output, image.number);
        frame.image = facts_of_image(image.file);
        if (is_kept(frame))
            return true;
        const double wall = wall_seconds(), cpu = thread_cpu_seconds();
        try {
            frame.environment = load(image.file, frame.report);
        } catch (const InputError& error) {
            frame.state = Frame::State::broken;
            frame.why = error.what();
            ended_ = settings_.stop_at_broken;
        }
        reading_.cpu_seconds += thread_cpu_seconds() - cpu;
        reading_.wall_seconds += wall_seconds() - wall;
        return true;
    }

    /// True for a frame of an earlier run; one that was set aside is put back.
    bool is_kept(Frame& frame) {
        const fs::path aside = outdated_name(frame.output);
        std::error_code error;
        if (!fs::exists(frame.output, error) && journal_.has(frame.number, frame.image, frame.output, aside))
            fs::rename(aside, frame.output, error);
        if (!journal_.has(frame.number, frame.image, frame.output, frame.output))
            return false;
        frame.state = Frame::State::kept;
        if (width_ == 0) // it tells the size that all have
            load(frame.image.file, frame.report);
        return true;
    }

    /// Throws InputError if the image is broken.
    Environment load(const fs::path& file, WorkReport& of_frame) {
        EnvironmentLoading loading = settings_.loading;
        loading.split = false;
        EnvironmentReport loaded;
        check_is_no_map(file);
        Environment environment = load_environment(file, loaded, loading);
        const Image& pixels = environment.remainder;
        if (width_ > 0 && (pixels.width != width_ || pixels.height != height_))
            throw InputError("'" + file.string() + "' is " + std::to_string(pixels.width) + " x " +
                             std::to_string(pixels.height) + ", not " + std::to_string(width_) + " x " +
                             std::to_string(height_) + " as the frames before it");
        width_ = pixels.width;
        height_ = pixels.height;
        environment.distant_lights = settings_.lights;
        of_frame.warnings = loaded.warnings;
        if (const auto skip = skipped_by_reduction(loaded, environment))
            of_frame.skips.push_back(*skip);
        return environment;
    }

    void bake(Frame& frame) {
        if (frame.state != Frame::State::ready)
            return;
        progress_.throw_if_stopped();
        if (!prepared_)
            prepare(frame.environment.remainder);
        map_.bake(frame.environment, baker_.get(), frame.report, within_a_frame_);
        const Stopwatch packing;
        frame.write = map_.packed(frame.output, frame.environment.description, frame.report);
        frame.report.stages.push_back({"packing texels", packing.cpu(), packing.wall()});
        frame.environment = {};
    }

    void prepare(const Image& image) {
        const Stopwatch watch;
        prepared_ = true;
        if (map_.layout().size() > 0)
            baker_ = make_baker(map_.layout(), image.width, image.height, settings_.baker, setup_, within_a_frame_);
        result_.setup_cpu_seconds = watch.cpu();
        result_.setup_wall_seconds = watch.wall();
    }

    void finish(Frame& frame) {
        if (frame.state == Frame::State::kept)
            ++result_.kept;
        else if (frame.state == Frame::State::broken)
            leave_out(frame);
        else
            write(frame);
        progress_.advance(1);
    }

    void write(Frame& frame) {
        const double wall = wall_seconds(), cpu = thread_cpu_seconds();
        frame.write();
        frame.write = nullptr;
        std::error_code not_there;
        fs::remove(outdated_name(frame.output), not_there);
        journal_.add_finished(frame.number, frame.image, frame.output);
        writing_.cpu_seconds += thread_cpu_seconds() - cpu;
        writing_.wall_seconds += wall_seconds() - wall;
        add_frame(work_, frame.report);
        ++result_.baked;
    }

    void leave_out(const Frame& frame) {
        std::string why = frame.why;
        std::error_code error;
        if (fs::exists(frame.output, error)) {
            const fs::path aside = outdated_name(frame.output);
            fs::rename(frame.output, aside, error);
            why += error ? "; '" + frame.output.string() + "' of an earlier run is outdated, but can't be renamed (" +
                               error.message() + ")"
                         : "; its map of an earlier run is now '" + aside.string() + "'";
        }
        journal_.add_broken(frame.number, frame.image, frame.why);
        if (settings_.stop_at_broken)
            throw InputError("frame " + std::to_string(frame.number) + " is broken: " + why +
                             "; finished frames stay, and the same command goes on");
        ++result_.broken;
        if (result_.first_broken.size() < kMostNamed)
            result_.first_broken.push_back({frame.number, why});
    }

    /// Of all CPU time, baking is what the others leave: its stages were measured with reading and writing beside them.
    void tell_times(double cpu_seconds) {
        result_.reading_cpu_seconds = reading_.cpu_seconds;
        result_.writing_cpu_seconds = writing_.cpu_seconds;
        result_.baking_cpu_seconds =
            std::max(0.0, cpu_seconds - result_.setup_cpu_seconds - reading_.cpu_seconds - writing_.cpu_seconds);
        double measured = 0;
        for (const WorkReport::Stage& stage : work_.stages)
            measured += stage.cpu_seconds;
        for (WorkReport::Stage& stage : work_.stages)
            if (measured > result_.baking_cpu_seconds)
                stage.cpu_seconds *= result_.baking_cpu_seconds / measured;
        work_.stages.insert(work_.stages.begin(), reading_);
        work_.stages.insert(work_.stages.begin(), setup_.stages.begin(), setup_.stages.end());
        work_.stages.push_back(writing_);
        setup_.stages.clear();
        work_.append(setup_);
    }

    const std::vector<SequenceImage>& images_;
    const SequenceSettings& settings_;
    BakedMap& map_;
    Progress& progress_;
    OnlyStops within_a_frame_;
    SequenceJournal journal_;
    std::array<Frame, kPlaces> frames_;

    // Of reading alone.
    std::size_t next_ = 0;
    bool ended_ = false;
    int width_ = 0, height_ = 0;
    WorkReport::Stage reading_{"reading"};
    // Of baking alone.
    std::unique_ptr<Baker> baker_;
    bool prepared_ = false;
    WorkReport setup_;
    // Of writing alone.
    WorkReport::Stage writing_{"writing"};
    WorkReport work_; ///< of all frames that are baked

    SequenceResult result_; ///< each step has its own figures in it
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

double SequenceResult::frames_per_second() const {
    return baked > 0 ? double(baked) / (wall_seconds - setup_wall_seconds) : 0;
}

fs::path outdated_name(const fs::path& map) {
    return map.string() + ".outdated";
}

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
    progress.begin("baking frames", images.size());
    return SequenceBake(images, settings, map, progress).run(report);
}

} // namespace kokage
