#pragma once

#include "capture_io/capture.h"
