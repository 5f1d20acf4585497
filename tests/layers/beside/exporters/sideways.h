#include "placing/placing.h"
