#include "calibration/board.h"
