#pragma once
// What reading and writing of images share. Private to common/scene.
#include "common/scene/image.h"

#include <string>

namespace kokage {

/// What OpenImageIO says, as one line; `otherwise` if it says nothing, or something about itself ("Is it a file format
/// that OpenImageIO doesn't know about?").
std::string one_line(std::string text, const char* otherwise);

/// Lets OpenImageIO use as many threads as the program does.
void use_our_thread_count();

/// An image of 1 to 4 channels with 1, 3 or 4 (0: as it is): grey is repeated, missing alpha is 1, superfluous alpha is
/// dropped; colour to 1 channel takes the first.
Image convert_channels(Image image, int channels);

} // namespace kokage
