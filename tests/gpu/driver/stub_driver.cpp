// A driver of no device that counts how often it is called: libcuda.so.1 for driver_calls_test.
#include <cstring>

namespace {

constexpr int success = 0, not_initialised = 3, no_device = 100, invalid_context = 201;

int calls = 0;    // of functions that start the driver or need it started
bool up = false;  // as after cuInit on a machine with a device
int device = -1;  // of the context that is current, -1: none
int unused = -1;  // a device without a context

}  // namespace

extern "C" {

int stub_driver_calls() { return calls; }
void stub_driver_start(int current) {
  up = true;
  device = current;
}

void stub_driver_unused(int ordinal) { unused = ordinal; }
int cuDevicePrimaryCtxGetState(int ordinal, unsigned* flags, int* active) {
  *flags = 0;
  *active = ordinal == unused ? 0 : 1;
  return success;
}

int cuInit(unsigned) {
  ++calls;
  return no_device;
}
int cuDriverGetVersion(int* version) {
  ++calls;
  *version = 13000;
  return success;
}
int cuCtxGetDevice(int* ordinal) {
  if (!up) return not_initialised;
  if (device < 0) return invalid_context;
  *ordinal = device;
  return success;
}

/// Any function of the driver that the run-time library asks for.
int stub_driver_any() {
  ++calls;
  return no_device;
}
int cuGetProcAddress_v2(const char* name, void** function, int, unsigned long long, int* status) {
  ++calls;
  *function = std::strcmp(name, "cuInit") == 0 ? reinterpret_cast<void*>(cuInit)
              : std::strcmp(name, "cuDriverGetVersion") == 0
                  ? reinterpret_cast<void*>(cuDriverGetVersion)
                  : reinterpret_cast<void*>(stub_driver_any);
  if (status != nullptr) *status = 0;
  return success;
}
int cuGetProcAddress(const char* name, void** function, int version, unsigned long long flags) {
  return cuGetProcAddress_v2(name, function, version, flags, nullptr);
}

}  // extern "C"
