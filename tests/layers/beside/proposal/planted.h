#include "estimation/model/model.h"
