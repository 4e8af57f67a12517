#include "common/scene/png_file.h"

#include <algorithm>
#include <csetjmp>
#include <cstring>
#include <png.h>
#include <string>
#include <string_view>
#include <vector>

namespace kokage {

/// libpng jumps back to where it was called from when something is wrong, over whatever lies between. So all that it is
/// called with lives here, and the functions that call it own nothing.
struct PngFile::State {
    std::span<const std::byte> bytes;
    std::size_t at = 0;
    png_structp png = nullptr;
    png_infop info = nullptr;
    bool cut_off = false;
    std::string message; ///< libpng's
    std::vector<unsigned char> values;
    std::vector<png_bytep> rows;

    ~State() { png_destroy_read_struct(&png, &info, nullptr); }

    static State& of(png_structp png) { return *static_cast<State*>(png_get_error_ptr(png)); }

    [[noreturn]] static void fail(png_structp png, png_const_charp message) {
        of(png).message = message;
        png_longjmp(png, 1);
    }

    /// libpng goes on without transparency if that is damaged. A mask must not be lost in silence.
    static void warn(png_structp png, png_const_charp message) {
        if (std::string_view(message).starts_with("tRNS"))
            fail(png, message);
    }

    static void give(png_structp png, png_bytep to, std::size_t count) {
        State& state = of(png);
        if (count > state.bytes.size() - state.at) {
            state.cut_off = true;
            fail(png, "cut off");
        }
        std::memcpy(to, state.bytes.data() + state.at, count);
        state.at += count;
    }

    bool read_header() {
        if (setjmp(png_jmpbuf(png)) != 0)
            return false;
        png_set_read_fn(png, this, &State::give);
        png_set_user_limits(png, 0x7fffffff, 0x7fffffff);                      // the caller has limits of its own
        png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, nullptr, -1); // all but those named in the header
        png_read_info(png, info);
        png_set_expand(png);
        png_set_interlace_handling(png);
        return true;
    }

    bool begin_pixels() {
        if (setjmp(png_jmpbuf(png)) != 0)
            return false;
        png_read_update_info(png, info);
        return true;
    }

    bool read_pixels() {
        if (setjmp(png_jmpbuf(png)) != 0)
            return false;
        png_read_image(png, rows.data());
        png_read_end(png, nullptr);
        return true;
    }

    [[noreturn]] void complain(const char* what) const {
        throw PngError(cut_off ? "it is cut off" : "its " + std::string(what) + " damaged (" + message + ")");
    }
};

PngFile::PngFile(std::span<const std::byte> png) : state_(std::make_unique<State>()) {
    State& state = *state_;
    state.bytes = png;
    state.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &state, &State::fail, &State::warn);
    state.info = state.png ? png_create_info_struct(state.png) : nullptr;
    if (!state.info)
        throw std::bad_alloc();
    if (!state.read_header())
        state.complain("header is");
}

PngFile::~PngFile() = default;

int PngFile::width() const {
    return int(png_get_image_width(state_->png, state_->info));
}
int PngFile::height() const {
    return int(png_get_image_height(state_->png, state_->info));
}

int PngFile::channels() const {
    const int type = png_get_color_type(state_->png, state_->info);
    const bool alpha =
        (type & PNG_COLOR_MASK_ALPHA) != 0 || png_get_valid(state_->png, state_->info, PNG_INFO_tRNS) != 0;
    return ((type & PNG_COLOR_MASK_COLOR) != 0 ? 3 : 1) + (alpha ? 1 : 0);
}

int PngFile::bits() const {
    return png_get_bit_depth(state_->png, state_->info) == 16 ? 16 : 8;
}

Image PngFile::pixels() {
    State& state = *state_;
    Image image(width(), height(), channels());
    const bool wide = bits() == 16;
    if (!state.begin_pixels())
        state.complain("header is");
    const std::size_t row = std::size_t(image.width) * std::size_t(image.channels) * (wide ? 2 : 1);
    if (png_get_rowbytes(state.png, state.info) != row)
        throw PngError("its pixels are of a kind that libpng does not expand");
    state.values.resize(row * std::size_t(image.height));
    for (std::size_t y = 0; y < std::size_t(image.height); ++y)
        state.rows.push_back(state.values.data() + y * row);
    if (!state.read_pixels())
        state.complain("pixels are");
    const unsigned char* values = state.values.data();
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        image.pixels[i] = wide ? float(values[2 * i] << 8 | values[2 * i + 1]) / 65535.f : float(values[i]) / 255.f;
    return image;
}

} // namespace kokage
