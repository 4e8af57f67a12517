#include "common/scene/image_layers.h"
#include "common/scene/image_io.h"
#include "common/services/error.h"
#include "common/services/named_file.h"
#include "common/services/output_file.h"

#include <OpenImageIO/imageio.h>
#include <algorithm>
#include <cmath>
#include <cstdint>

namespace kokage {
namespace {

constexpr const char* kLayersUnwritable = "the system did not take it (is the disk full?)";
constexpr int kRows = 64; ///< written at a time; a multiple of the rows that are compressed together
constexpr std::uint64_t kMostPixels = std::uint64_t(1) << 28;

[[noreturn]] void fail_to_write(const std::filesystem::path& path, const std::string& why) {
    throw InputError("cannot write image '" + path.string() + "': " + why);
}

[[noreturn]] void fail_to_read(const std::filesystem::path& path, const std::string& why) {
    throw InputError("cannot read image '" + path.string() + "': " + why);
}

void check_layer(const std::filesystem::path& path, const ImageLayer& layer, const Image& first) {
    const Image& image = layer.image;
    const std::string name = layer.name.empty() ? "the picture" : "layer '" + layer.name + "'";
    if (image.empty() || image.width != first.width || image.height != first.height ||
        layer.channel_names.size() != std::size_t(image.channels))
        fail_to_write(path, name + " is empty, or of another size than the others");
    const auto bad =
        std::find_if(image.pixels.begin(), image.pixels.end(), [](float value) { return std::isnan(value); });
    if (bad == image.pixels.end())
        return;
    const std::size_t pixel = std::size_t(bad - image.pixels.begin()) / std::size_t(image.channels);
    fail_to_write(path, name + ": pixel (" + std::to_string(pixel % std::size_t(image.width)) + ", " +
                            std::to_string(pixel / std::size_t(image.width)) + ") is NaN");
}

/// Some rows of all layers' channels, interleaved.
std::vector<float> interleaved(const std::vector<ImageLayer>& layers, int channels, int first_row, int end_row) {
    const int width = layers.front().image.width;
    std::vector<float> values(std::size_t(width) * std::size_t(end_row - first_row) * std::size_t(channels));
    std::size_t channel = 0;
    for (const ImageLayer& layer : layers) {
        float* out = values.data() + channel;
        for (int y = first_row; y < end_row; ++y)
            for (int x = 0; x < width; ++x, out += channels)
                std::copy_n(layer.image.at(x, y), layer.image.channels, out);
        channel += std::size_t(layer.image.channels);
    }
    return values;
}

bool write_rows(OIIO::ImageOutput& output, const std::vector<ImageLayer>& layers, int channels) {
    const int height = layers.front().image.height;
    for (int y = 0; y < height; y += kRows) {
        const int end = std::min(height, y + kRows);
        if (!output.write_scanlines(y, end, 0, OIIO::TypeDesc::FLOAT, interleaved(layers, channels, y, end).data()))
            return false;
    }
    return true;
}

/// "direct.R" belongs to "direct".
std::string layer_of(const std::string& channel) {
    const std::size_t dot = channel.rfind('.');
    return dot == std::string::npos ? "" : channel.substr(0, dot);
}

} // namespace

void save_layers(const std::filesystem::path& path, const std::vector<ImageLayer>& layers) {
    if (lower_ending(path) != ".exr")
        fail_to_write(path, "layers need a name that ends in .exr");
    if (layers.empty())
        fail_to_write(path, "there are no layers");
    OIIO::ImageSpec spec(layers.front().image.width, layers.front().image.height, 0, OIIO::TypeDesc::FLOAT);
    for (const ImageLayer& layer : layers) {
        check_layer(path, layer, layers.front().image);
        for (const std::string& channel : layer.channel_names)
            spec.channelnames.push_back(layer.name.empty() ? channel : layer.name + "." + channel);
    }
    spec.attribute("DateTime", ""); // else the time of writing: the same picture would be other bytes each time
    spec.nchannels = int(spec.channelnames.size());
    spec.attribute("oiio:ColorSpace", "Linear");
    spec.attribute("compression", "zip");
    use_our_thread_count();
    OutputFile file(path);
    const auto output = OIIO::ImageOutput::create("exr");
    if (!output)
        fail_to_write(path, one_line(OIIO::geterror(), kLayersUnwritable));
    if (!output->open(file.temporary_path().string(), spec) || !write_rows(*output, layers, spec.nchannels) ||
        !output->close())
        fail_to_write(path, one_line(output->geterror(), kLayersUnwritable));
    file.commit();
}

std::vector<ImageLayer> load_layers(const std::filesystem::path& path) {
    use_our_thread_count();
    const auto input = OIIO::ImageInput::open(path.string());
    if (!input)
        fail_to_read(path, one_line(OIIO::geterror(), "it is no image"));
    const OIIO::ImageSpec spec = input->spec();
    if (std::uint64_t(spec.width) * std::uint64_t(spec.height) * std::uint64_t(spec.nchannels) > 4 * kMostPixels)
        fail_to_read(path, "it is too large");
    std::vector<ImageLayer> layers;
    for (int c = 0; c < spec.nchannels;) {
        int end = c;
        const std::string name = layer_of(spec.channelnames[std::size_t(c)]);
        ImageLayer layer{.name = name, .channel_names = {}, .image = {}};
        for (; end < spec.nchannels && layer_of(spec.channelnames[std::size_t(end)]) == name; ++end)
            layer.channel_names.push_back(
                spec.channelnames[std::size_t(end)].substr(name.empty() ? 0 : name.size() + 1));
        layer.image = Image(spec.width, spec.height, end - c);
        if (!input->read_image(0, 0, c, end, OIIO::TypeDesc::FLOAT, layer.image.pixels.data()))
            fail_to_read(path, one_line(input->geterror(), "it is damaged"));
        layers.push_back(std::move(layer));
        c = end;
    }
    return layers;
}

} // namespace kokage
