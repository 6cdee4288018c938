// The bridge to OpenImageIO, the one C++ file and a module of its own. It moves samples and decides nothing about
// colour.
#include "core/pictures/openimageio_bridge.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <mutex>
#include <new>
#include <string>
#include <vector>

#include "conic/export.h"
#include "conic/version.h"

namespace {

conic_bridge_result fail(char *message, std::string text) {
  // OpenImageIO joins messages by line ends; ours are one line.
  for (char &c : text)
    if (c == '\n' || c == '\r')
      c = ' ';
  text.erase(text.find_last_not_of(' ') + 1);
  if (text.empty())
    text = "OpenImageIO gives no reason";
  const size_t n = std::min(text.size(), size_t(CONIC_BRIDGE_MESSAGE - 1));
  std::memcpy(message, text.data(), n);
  message[n] = 0;
  return CONIC_BRIDGE_FAILED;
}

// Runs `work`, turning every exception into a result.
// OpenImageIO's own pool of threads would outlive every call: pictures are read and written one at a time.
template <typename Work> conic_bridge_result guarded(char *message, const Work &work) {
  try {
    static const bool is_alone = OIIO::attribute("threads", 1) && OIIO::attribute("exr_threads", -1);
    (void)is_alone;
    return work();
  } catch (const std::bad_alloc &) {
    return CONIC_BRIDGE_MEMORY;
  } catch (const std::exception &exception) {
    return fail(message, exception.what());
  } catch (...) {
    return fail(message, "OpenImageIO failed");
  }
}

OIIO::TypeDesc type_of(int sample_bytes) {
  return sample_bytes == 1 ? OIIO::TypeDesc::UINT8 : sample_bytes == 2 ? OIIO::TypeDesc::UINT16 : OIIO::TypeDesc::FLOAT;
}

// What makes the pictures good, and quick to write. "term" would print on the terminal and "null" write nothing.
bool is_refused(const std::string &format) {
  return format == "term" || format == "null";
}

OIIO::ImageSpec spec_of(const conic_bridge_picture &picture, const std::string &format) {
  OIIO::ImageSpec spec(picture.width, picture.height, picture.n_channels, type_of(picture.sample_bytes));
  if (format != "tiff") // there it would become a second directory, which breaks files written to memory
    spec.attribute("oiio:ColorSpace", picture.sample_bytes == 4 ? "Linear" : "sRGB");
  if (picture.is_straight)
    spec.attribute("oiio:UnassociatedAlpha", 1);
  if (format == "png")
    spec.attribute("png:compressionLevel", 1);
  if (format == "tiff") {
    spec.attribute("compression", "zip");
    spec.attribute("DateTime", ""); // the same picture is the same file, whenever it is written
    if (picture.description)
      spec.attribute("ImageDescription", picture.description);
  }
  if (format == "jpeg") {
    spec.attribute("Compression", "jpeg:95");
    spec.attribute("jpeg:subsampling", "4:4:4");
  }
  return spec;
}

// All samples at once, but the rows of a TIFF one by one: of several at a time its reader takes those that cannot be
// decompressed for good.
bool read_samples(OIIO::ImageInput &input, const OIIO::TypeDesc &type, void *samples) {
  const OIIO::ImageSpec spec = input.spec();
  if (std::strcmp(input.format_name(), "tiff") != 0 || spec.tile_width > 0)
    return input.read_image(0, 0, 0, spec.nchannels, type, samples);
  const size_t row_bytes = size_t(spec.width) * size_t(spec.nchannels) * type.size();
  for (int y = 0; y < spec.height; y++)
    if (!input.read_scanlines(0, 0, spec.y + y, spec.y + y + 1, 0, 0, spec.nchannels, type,
                              static_cast<char *>(samples) + size_t(y) * row_bytes))
      return false;
  return true;
}

// An EXR's channels, each by its name. Those of numbers are read once more, as OpenImageIO makes fractions of the
// largest number there is where all are to be floats.
void name_channels(const OIIO::ImageSpec &spec, conic_bridge_picture &picture) {
  picture.is_named = 1;
  picture.sample_bytes = 4;
  for (int i = 0; i < spec.nchannels && i < CONIC_BRIDGE_CHANNELS; i++) {
    const std::string name = spec.channel_name(i);
    name.copy(picture.channels[i].name, sizeof picture.channels[i].name - 1);
    picture.channels[i].is_uint = spec.channelformat(i) == OIIO::TypeDesc::UINT32;
  }
}

bool read_numbers(OIIO::ImageInput &input, const conic_bridge_picture &picture, void *samples) {
  bool is_well = true;
  for (int i = 0; i < picture.n_channels && is_well; i++)
    if (picture.channels[i].is_uint)
      is_well = input.read_image(0, 0, i, i + 1, OIIO::TypeDesc::UINT32, static_cast<char *>(samples) + 4 * size_t(i),
                                 OIIO::stride_t(4) * picture.n_channels);
  return is_well;
}

conic_bridge_result find_writer(const char *ending, conic_bridge_writer *writer, char *message) {
  return guarded(message, [&] {
    auto output = OIIO::ImageOutput::create(ending);
    if (!output) {
      OIIO::geterror(); // or it would be reported by whoever asks next
      return fail(message, "no format is known by this ending");
    }
    const std::string format = output->format_name();
    if (is_refused(format))
      return fail(message, "no format is known by this ending");
    std::memset(writer, 0, sizeof *writer);
    format.copy(writer->format, sizeof writer->format - 1);
    writer->has_alpha = output->supports("alpha");
    return CONIC_BRIDGE_OK;
  });
}

conic_bridge_result write(const char *format, const conic_bridge_picture *picture, const void *samples,
                          int (*take)(void *cookie, const void *bytes, size_t n_bytes), void *cookie, char *message) {
  return guarded(message, [&] {
    OIIO::Filesystem::IOVecOutput memory;
    auto output = OIIO::ImageOutput::create(format);
    if (!output)
      return fail(message, OIIO::geterror());
    if (!output->supports("ioproxy") || !output->set_ioproxy(&memory))
      return fail(message, "OpenImageIO cannot write this format to a stream");
    if (!output->open(format, spec_of(*picture, output->format_name())) ||
        !output->write_image(type_of(picture->sample_bytes), samples) || !output->close())
      return fail(message, output->geterror());
    output.reset(); // some formats write their last bytes here
    if (memory.buffer().empty())
      return fail(message, "OpenImageIO wrote nothing");
    if (!take(cookie, memory.buffer().data(), memory.buffer().size()))
      return fail(message, "the file cannot be written");
    return CONIC_BRIDGE_OK;
  });
}

// Some readers decode where they open. What they may open is a setting of the whole process.
std::unique_ptr<OIIO::ImageInput> open_within(const char *path, int most_mib) {
  static std::mutex settings;
  const std::lock_guard<std::mutex> lock(settings);
  OIIO::ImageSpec wish;
  wish.attribute("oiio:UnassociatedAlpha", 1); // straight colour stays straight
  OIIO::attribute("limits:imagesize_MB", most_mib);
  return OIIO::ImageInput::open(path, &wish);
}

conic_bridge_result read(const char *path, int most_mib, conic_bridge_picture *picture,
                         void *(*make_room)(void *cookie, const conic_bridge_picture *picture), void *cookie,
                         char *message) {
  return guarded(message, [&] {
    auto input = open_within(path, most_mib);
    if (!input)
      return fail(message, OIIO::geterror());
    const OIIO::ImageSpec &spec = input->spec();
    std::memset(picture, 0, sizeof *picture);
    picture->width = spec.width;
    picture->height = spec.height;
    picture->n_channels = spec.nchannels;
    const OIIO::TypeDesc type = spec.format;
    picture->sample_bytes = type == OIIO::TypeDesc::UINT8 ? 1 : type.is_floating_point() ? 4 : 2;
    picture->is_straight = spec.get_int_attribute("oiio:UnassociatedAlpha", 0) != 0;
    if (std::strcmp(input->format_name(), "openexr") == 0)
      name_channels(spec, *picture);
    void *room = make_room(cookie, picture);
    if (!room)
      return CONIC_BRIDGE_MEMORY;
    // Some readers go on after an error, and have only noted it.
    if (!read_samples(*input, type_of(picture->sample_bytes), room) ||
        (picture->is_named && !read_numbers(*input, *picture, room)) || input->has_error())
      return fail(message, input->geterror());
    input->close();
    return CONIC_BRIDGE_OK;
  });
}

#define TEXT_OF(x) #x
#define TEXT(x) TEXT_OF(x)

} // namespace

extern "C" {
CONIC_API extern const conic_bridge conic_openimageio_bridge;
const conic_bridge conic_openimageio_bridge = {
    TEXT(CONIC_VERSION_MAJOR) "." TEXT(CONIC_VERSION_MINOR) "." TEXT(CONIC_VERSION_PATCH), find_writer, write, read};
}
