// What a helper answers: believed no more than a file.
#include "capture_io/file_storage.h"
#include "core/parcels.h"
#include "core/wire.h"
#include "fuzz.h"
#include "meshing/parcels.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace hookeye;
  if (size == 0) return 0;
  Unpacker from({reinterpret_cast<const char*>(data) + 1, size - 1});
  try {
    switch (data[0] % 5) {
      case 0:
        detail::unpack_volume(from);
        break;
      case 1:
        detail::unpack_surface(from);
        break;
      case 2:
        unpack_stored(from);
        break;
      case 3:
        unpack_read(from);
        break;
      default:
        unpack_stored_values(from);
    }
    from.end();
  } catch (const WireFault&) {
  }
  return 0;
}
