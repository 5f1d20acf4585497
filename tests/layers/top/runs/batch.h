#include "batch/batch_folder.h"
