#include "common/scene/image_io.h"

#include "common/scene/image_file.h"
#include "common/services/parallel.h"

#include <OpenImageIO/imageio.h>
#include <algorithm>
#include <atomic>
#include <cmath>

namespace kokage {

/// What OpenImageIO says, as one line; `otherwise` if it says nothing, or something about itself ("Is it a file format
/// that OpenImageIO doesn't know about?").
std::string one_line(std::string text, const char* otherwise) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    while (!text.empty() && text.back() == ' ')
        text.pop_back();
    const bool useless = text.empty() || text.back() == '?' || text.find("OpenImageIO") != std::string::npos;
    return useless ? otherwise : text;
}

namespace {
std::atomic<int> on_one_thread{0};
}

ImageFilesOnOneThread::ImageFilesOnOneThread() {
    ++on_one_thread;
}

ImageFilesOnOneThread::~ImageFilesOnOneThread() {
    --on_one_thread;
}

void use_our_thread_count() {
    const int threads = on_one_thread > 0 ? 1 : thread_count();
    OIIO::attribute("threads", threads);
    OIIO::attribute("exr_threads", threads == 1 ? -1 : threads); // 1 would be one more thread beside ours
}

Image convert_channels(Image image, int channels) {
    if (channels == 0 || channels == image.channels)
        return image;
    Image result(image.width, image.height, channels);
    const bool grey = image.channels <= 2, alpha = image.channels == 2 || image.channels == 4;
    const std::size_t count = std::size_t(image.width) * std::size_t(image.height);
    for (std::size_t i = 0; i < count; ++i) {
        const float* from = image.pixels.data() + i * std::size_t(image.channels);
        float* to = result.pixels.data() + i * std::size_t(channels);
        for (int c = 0; c < std::min(channels, 3); ++c)
            to[c] = from[grey ? 0 : c];
        if (channels == 4)
            to[3] = alpha ? from[image.channels - 1] : 1.f;
    }
    return result;
}

float linear_from_srgb(float value) {
    const float size = std::abs(value);
    return std::copysign(size <= 0.04045f ? size / 12.92f : std::pow((size + 0.055f) / 1.055f, 2.4f), value);
}

float srgb_from_linear(float value) {
    const float size = std::abs(value);
    return std::copysign(size <= 0.0031308f ? size * 12.92f : 1.055f * std::pow(size, 1 / 2.4f) - 0.055f, value);
}

} // namespace kokage
