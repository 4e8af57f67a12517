#include "common/scene/image_file.h"
#include "common/services/error.h"
#include "common/services/parallel.h"
#include "reflection/maps/bake_sequence.h"
#include "reflection/maps/map_file.h"
#include "tests/support/temporary_folder.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>

namespace kokage {
namespace {

namespace fs = std::filesystem;

void write_frame(const fs::path& file, int width, float shade) {
    Image image(width, width / 2, 3);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < width; ++x)
            image.at(x, y)[1] = shade * float(x) / float(width);
    save_image(file, image);
}

/// Files hold the time of their writing, too.
std::vector<glm::vec3> voxels_of(const fs::path& file) {
    const MapFile map = read_map(file);
    const std::span<const glm::vec3> voxels = std::get<VoxelCube>(map.map).voxels();
    return {voxels.begin(), voxels.end()};
}

MapSettings small_cube() {
    MapSettings settings;
    settings.container = MapContainer::voxel_cube;
    settings.size = 16;
    return settings;
}

/// Eight good frames; the given ones damaged.
struct Frames {
    TemporaryFolder folder;
    SequenceSettings settings;
    explicit Frames(const std::vector<int>& broken = {}) {
        for (int i = 1; i <= 8; ++i)
            write_frame(folder / ("in_0" + std::to_string(i) + ".exr"), 32, 0.1f * float(i));
        for (int i : broken)
            std::ofstream(folder / ("in_0" + std::to_string(i) + ".exr")) << "no picture";
        settings.output = (folder / "maps" / "m%03d.exr").string();
        settings.baker.method = BakeMethod::table;
    }
    std::string pattern() const { return (folder / "in_%02d.exr").string(); }
    fs::path map_file(int i) const { return folder / "maps" / ("m00" + std::to_string(i) + ".exr"); }
    SequenceResult run(Progress& progress = silent_progress()) const {
        const std::unique_ptr<BakedMap> map = make_map(small_cube());
        WorkReport report;
        return bake_sequence(image_sequence(pattern()), settings, *map, report, progress);
    }
};

std::size_t files_in(const fs::path& folder) {
    return std::size_t(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

/// Wants to stop after so many frames.
class StopAfter : public Progress {
  public:
    explicit StopAfter(std::size_t frames) : left_(frames) {}
    void advance(std::size_t) override {
        if (left_ > 0)
            --left_;
    }
    bool stop_requested() const override { return left_ == 0; }

  private:
    std::atomic<std::size_t> left_;
};

/// Does something when it is asked for the n-th time whether to stop: with one thread, the first frame is read between
/// the first and the second time.
class AtQuestion : public Progress {
  public:
    AtQuestion(int number, std::function<void()> act) : left_(number), act_(std::move(act)) {}
    bool stop_requested() const override {
        if (--left_ == 0)
            act_();
        return false;
    }

  private:
    mutable std::atomic<int> left_;
    std::function<void()> act_;
};

class WithThreads {
  public:
    explicit WithThreads(int count) { set_thread_count(count); }
    ~WithThreads() { set_thread_count(0); }
    WithThreads(const WithThreads&) = delete;
    WithThreads& operator=(const WithThreads&) = delete;
};

TEST(BakeSequence, EveryFrameIsWhatItWouldBeAlone) {
    const Frames frames;
    const SequenceResult result = frames.run();
    EXPECT_EQ(result.baked, 8u);
    EXPECT_EQ(result.broken, 0u);
    for (int i : {1, 5, 8}) {
        const std::unique_ptr<BakedMap> map = make_map(small_cube());
        EnvironmentReport loaded;
        const Environment environment =
            load_environment(frames.folder / ("in_0" + std::to_string(i) + ".exr"), loaded, {.split = false});
        WorkReport report;
        map->bake(environment, make_baker(map->layout(), 32, 16, frames.settings.baker, report).get(), report);
        map->write(frames.folder / "alone.exr", environment.description, report);
        EXPECT_TRUE(voxels_of(frames.map_file(i)) == voxels_of(frames.folder / "alone.exr")) << i;
    }
}

TEST(BakeSequence, AStoppedRunKeepsItsFramesAndGoesOn) {
    const Frames frames;
    StopAfter stop(3);
    EXPECT_THROW(frames.run(stop), Stopped);
    // Those that were baked when the wish came are written, too; no half file is left.
    const std::size_t files = files_in(frames.folder / "maps");
    EXPECT_TRUE(fs::exists(frames.map_file(3)));
    EXPECT_FALSE(fs::exists(frames.map_file(8)));
    const auto before = fs::last_write_time(frames.map_file(2));
    const SequenceResult result = frames.run();
    EXPECT_EQ(result.kept + 1, files) << "each has its line in the journal, which is a file, too";
    EXPECT_EQ(result.kept + result.baked, 8u);
    EXPECT_EQ(fs::last_write_time(frames.map_file(2)), before) << "finished frames are not touched";
    const SequenceResult again = frames.run();
    EXPECT_EQ(again.kept, 8u);
    EXPECT_EQ(again.baked, 0u);
}

TEST(BakeSequence, SameBitsWithAnyNumberOfThreads) {
    std::vector<std::vector<glm::vec3>> voxels;
    for (const int threads : {1, 2, 4}) {
        const WithThreads with(threads);
        Frames frames({5});
        frames.settings.baker.method = BakeMethod::spectral;
        EXPECT_EQ(frames.run().baked, 7u);
        for (int i : {1, 4, 8})
            voxels.push_back(voxels_of(frames.map_file(i)));
    }
    for (std::size_t i = 3; i < voxels.size(); ++i)
        EXPECT_TRUE(voxels[i] == voxels[i % 3]) << i;
}

TEST(BakeSequence, AnImageThatChangesWhileItIsBakedIsBakedAgain) {
    const WithThreads one(1);
    const Frames frames;
    const std::vector<glm::vec3> before = [&] {
        const Frames same;
        same.run();
        return voxels_of(same.map_file(1));
    }();
    AtQuestion change(2, [&] {
        write_frame(frames.folder / "in_01.exr", 32, 0.9f);
        fs::last_write_time(frames.folder / "in_01.exr", fs::file_time_type::clock::now() + std::chrono::seconds(5));
    });
    EXPECT_EQ(frames.run(change).baked, 8u);
    EXPECT_TRUE(voxels_of(frames.map_file(1)) == before) << "it was read before it changed";
    const SequenceResult again = frames.run();
    EXPECT_EQ(again.baked, 1u);
    EXPECT_EQ(again.kept, 7u);
    EXPECT_FALSE(voxels_of(frames.map_file(1)) == before);
}

TEST(BakeSequence, AMapWhoseImageHasBecomeBrokenIsSetAsideAndTakenBackWithItsImage) {
    const Frames frames;
    frames.run();
    const std::vector<glm::vec3> map = voxels_of(frames.map_file(4));
    const fs::path image = frames.folder / "in_04.exr", hidden = frames.folder / "elsewhere";
    fs::rename(image, hidden);
    std::ofstream(image) << "no picture";
    const SequenceResult result = frames.run();
    EXPECT_EQ(result.broken, 1u);
    EXPECT_EQ(result.kept, 7u);
    EXPECT_FALSE(fs::exists(frames.map_file(4)));
    EXPECT_EQ(outdated_name(frames.map_file(4)).filename(), "m004.exr.outdated");
    EXPECT_TRUE(fs::exists(outdated_name(frames.map_file(4))));
    ASSERT_EQ(result.first_broken.size(), 1u);
    EXPECT_NE(result.first_broken[0].why.find("m004.exr.outdated"), std::string::npos) << result.first_broken[0].why;
    EXPECT_EQ(frames.run().broken, 1u) << "nothing new happens to it";
    EXPECT_TRUE(fs::exists(outdated_name(frames.map_file(4))));

    fs::rename(hidden, image); // with its old time
    EXPECT_EQ(frames.run().kept, 8u);
    EXPECT_TRUE(voxels_of(frames.map_file(4)) == map);
    EXPECT_FALSE(fs::exists(outdated_name(frames.map_file(4))));

    std::ofstream(image) << "no picture";
    frames.run();
    write_frame(image, 32, 0.7f); // another one
    EXPECT_EQ(frames.run().baked, 1u);
    EXPECT_TRUE(fs::exists(frames.map_file(4)));
    EXPECT_FALSE(fs::exists(outdated_name(frames.map_file(4)))) << "made up for";
}

TEST(BakeSequence, FramesBeforeOneThatCantBeWrittenAreFinished) {
    const Frames frames;
    fs::create_directories(frames.map_file(5));
    EXPECT_THROW(frames.run(), InputError);
    EXPECT_TRUE(fs::exists(frames.map_file(4)));
    EXPECT_FALSE(fs::exists(frames.map_file(6)));
    EXPECT_EQ(files_in(frames.folder / "maps"), 6u) << "four maps, the folder and the journal";
    fs::remove(frames.map_file(5));
    EXPECT_EQ(frames.run().kept, 4u);
}

TEST(BakeSequence, TellsTheTimesOfItsStepsAndThatImagesWereReducedOnce) {
    Frames frames;
    for (int i = 1; i <= 8; ++i) {
        Image wide(4098, 4, 3);
        std::fill(wide.pixels.begin(), wide.pixels.end(), 0.1f * float(i));
        save_image(frames.folder / ("in_0" + std::to_string(i) + ".exr"), wide);
    }
    const std::unique_ptr<BakedMap> map = make_map(small_cube());
    WorkReport report;
    const SequenceResult result = bake_sequence(image_sequence(frames.pattern()), frames.settings, *map, report);
    EXPECT_EQ(result.baked, 8u);
    EXPECT_GT(result.reading_cpu_seconds, 0);
    EXPECT_GT(result.baking_cpu_seconds, 0);
    EXPECT_GT(result.writing_cpu_seconds, 0);
    EXPECT_GT(result.setup_cpu_seconds, 0);
    EXPECT_GT(result.frames_per_second(), 8 / result.wall_seconds);
    EXPECT_EQ(std::count_if(report.skips.begin(), report.skips.end(),
                            [](const auto& skip) { return skip.saved == "4098 columns became 4096"; }),
              1)
        << (report.skips.empty() ? "" : report.skips.front().saved);
    ASSERT_GT(report.stages.size(), 3u);
    EXPECT_EQ(report.stages.back().name, "writing");
    double baking = 0;
    for (const WorkReport::Stage& stage : report.stages)
        EXPECT_EQ(std::count_if(report.stages.begin(), report.stages.end(),
                                [&](const auto& other) { return other.name == stage.name; }),
                  1)
            << stage.name;
    const auto reading = std::find_if(report.stages.begin(), report.stages.end(),
                                      [](const auto& stage) { return stage.name == "reading"; });
    ASSERT_NE(reading, report.stages.end());
    for (auto stage = reading + 1; stage + 1 != report.stages.end(); ++stage)
        baking += stage->cpu_seconds;
    EXPECT_LE(baking, result.baking_cpu_seconds * 1.0001) << "parts are no more than the whole";
}

TEST(BakeSequence, AChangedImageOrALostMapIsBakedAgain) {
    const Frames frames;
    frames.run();
    write_frame(frames.folder / "in_04.exr", 32, 0.9f);
    fs::last_write_time(frames.folder / "in_04.exr", fs::file_time_type::clock::now() + std::chrono::seconds(5));
    fs::remove(frames.map_file(6));
    const SequenceResult result = frames.run();
    EXPECT_EQ(result.baked, 2u);
    EXPECT_EQ(result.kept, 6u);
}

TEST(BakeSequence, AnotherRunKeepsTheSizeOfTheFirstFrame) {
    Frames frames;
    write_frame(frames.folder / "in_02.exr", 64, 0.5f); // another size: left out
    EXPECT_EQ(frames.run().broken, 1u);
    fs::remove(frames.map_file(4));
    const SequenceResult result = frames.run();
    EXPECT_EQ(result.kept, 6u);
    EXPECT_EQ(result.baked, 1u);
    ASSERT_EQ(result.first_broken.size(), 1u);
    EXPECT_EQ(result.first_broken.front().number, 2u);
}

TEST(BakeSequence, ImagesAreNeverWrittenOver) {
    Frames frames;
    const auto bytes = fs::file_size(frames.folder / "in_03.exr");
    frames.settings.output = (frames.folder / "maps" / ".." / "in_%02d.exr").string();
    fs::create_directory(frames.folder / "maps");
    EXPECT_THROW(frames.run(), InputError);
    frames.settings.output = (frames.folder / "maps" / "m%03d.exr").string();
    frames.settings.baker.stored_setup = frames.folder / "in_03.exr";
    EXPECT_THROW(frames.run(), InputError);
    EXPECT_EQ(fs::file_size(frames.folder / "in_03.exr"), bytes);
}

TEST(BakeSequence, AJournalThatWasCutOffGoesOnFromItsLastWholeLine) {
    const Frames frames;
    frames.run();
    const fs::path journal = journal_of(frames.settings.output);
    EXPECT_EQ(journal.filename(), "m-journal.jsonl");
    fs::resize_file(journal, fs::file_size(journal) - 5);
    EXPECT_EQ(frames.run().baked, 1u);
    EXPECT_EQ(frames.run().baked, 0u) << "the line that was cut off is whole again";
    for (const char* other : {"no journal\n", "{\"kokage_frames\":1,\"settings\":5}\n"}) {
        std::ofstream(journal) << other;
        EXPECT_THROW(frames.run(), InputError) << other;
    }
}

TEST(BakeSequence, BrokenFramesAreNamedAndLeftOutOrStopTheRun) {
    Frames frames({3, 6});
    write_frame(frames.folder / "in_07.exr", 64, 0.5f); // another size
    const SequenceResult result = frames.run();
    EXPECT_EQ(result.baked, 5u);
    EXPECT_EQ(result.broken, 3u);
    ASSERT_EQ(result.first_broken.size(), 3u);
    EXPECT_EQ(result.first_broken[0].number, 3u);
    EXPECT_NE(result.first_broken[0].why.find("in_03.exr"), std::string::npos);
    EXPECT_NE(result.first_broken[2].why.find("64 x 32, not 32 x 16"), std::string::npos);
    EXPECT_FALSE(fs::exists(frames.map_file(3)));
    // A frame that was mended since is made up for.
    write_frame(frames.folder / "in_03.exr", 32, 0.5f);
    EXPECT_EQ(frames.run().baked, 1u);

    frames.settings.stop_at_broken = true;
    try {
        frames.run();
        FAIL();
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("frame 6 is broken"), std::string::npos) << error.what();
    }
    EXPECT_TRUE(fs::exists(frames.map_file(5)));
}

TEST(BakeSequence, RefusesAJournalOfOtherSettingsAndASequenceOfNothingThatCanBeRead) {
    Frames frames;
    frames.settings.identity = R"({"size": 16})";
    frames.run();
    frames.settings.identity = R"({"size": 32})";
    try {
        frames.run();
        FAIL();
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("another size (16, not 32)"), std::string::npos) << error.what();
    }
    EXPECT_THROW(Frames({1, 2, 3, 4, 5, 6, 7, 8}).run(), InputError);
}

TEST(ImageSequence, FindsFramesByPatternFolderAndList) {
    const Frames frames;
    std::ofstream(frames.folder / "in_9.exr") << "";  // not as %02d writes it
    std::ofstream(frames.folder / "in_0x.exr") << ""; // no number
    std::ofstream(frames.folder / "notes.md") << "";  // no image
    fs::rename(frames.folder / "in_08.exr", frames.folder / "in_12.exr");
    const auto by_pattern = image_sequence(frames.pattern());
    ASSERT_EQ(by_pattern.size(), 8u);
    EXPECT_EQ(by_pattern.front().number, 1u);
    EXPECT_EQ(by_pattern.back().number, 12u);
    EXPECT_EQ(by_pattern.back().file.filename(), "in_12.exr");
    EXPECT_EQ(image_sequence(frames.folder.path().string()).size(), 10u);
    std::ofstream(frames.folder / "list.txt") << "# frames\nin_02.exr\n\nin_01.exr\r\n/nowhere/x.hdr\n";
    const auto by_list = image_sequence((frames.folder / "list.txt").string());
    ASSERT_EQ(by_list.size(), 3u);
    EXPECT_EQ(by_list[1].file, frames.folder / "in_01.exr");
    EXPECT_EQ(by_list[1].number, 2u);
    EXPECT_EQ(by_list[2].file, "/nowhere/x.hdr");
    EXPECT_THROW(image_sequence((frames.folder / "out_%d.exr").string()), InputError);
    EXPECT_THROW(image_sequence("/nowhere/in_%d.exr"), InputError);
}

TEST(ImageSequence, NumbersStandInTheirPlace) {
    EXPECT_TRUE(has_number_place("a_%04d.exr"));
    EXPECT_TRUE(has_number_place("%d"));
    EXPECT_FALSE(has_number_place("a.exr"));
    EXPECT_FALSE(has_number_place("50%.exr"));
    EXPECT_FALSE(has_number_place("%d_%d.exr"));
    EXPECT_FALSE(has_number_place("%s.exr"));
    EXPECT_FALSE(has_number_place("%99999999999999999999d.exr"));
    EXPECT_EQ(numbered_name("a_%04d.exr", 17), "a_0017.exr");
    EXPECT_EQ(numbered_name("a_%d.exr", 12345), "a_12345.exr");
    EXPECT_EQ(numbered_name("a_%02d.exr", 12345), "a_12345.exr");
}

} // namespace
} // namespace kokage
