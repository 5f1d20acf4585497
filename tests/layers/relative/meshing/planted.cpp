#include "../capture_io/capture.h"
