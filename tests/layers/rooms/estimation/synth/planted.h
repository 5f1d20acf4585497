#include "estimation/diagnosis/diagnosis.h"
