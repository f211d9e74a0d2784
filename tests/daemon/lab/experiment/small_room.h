// A small room with two access points, as a plan, for the tests of experiments.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace rayloc::test {

inline std::string small_room_plan() {
  std::string text = R"(name = "closet"
size = [3.4, 2.8, 2.5]
floor = "concrete"
ceiling = "concrete"
walls = "brick"
[[box]]
name = "cabinet"
material = "metal"
centre = [1.7, 1.4, 0.75]
size = [0.5, 0.4, 1.5]
)";
  for (const char* pose : {"id = \"ap1\"\nposition = [0.3, 0.3, 1.2]\nyaw_deg = 40\n",
                           "id = \"ap2\"\nposition = [3.1, 0.3, 1.2]\nyaw_deg = 140\n"}) {
    text += std::string("[[access_point]]\n") + pose + "pattern = \"half_wave_dipole\"\n";
    text += "[[access_point.antenna]]\ncore = 2\noffset = [0, -0.089, 0]\n";
    text += "[[access_point.antenna]]\ncore = 0\noffset = [0, 0, 0]\n";
    text += "[[access_point.antenna]]\ncore = 3\noffset = [0, 0.089, 0]\n";
  }
  return text;
}

// A folder with the plan, "room.toml", in it; gone with the object.
class SmallRoomFolder {
 public:
  explicit SmallRoomFolder(const std::string& name)
      : path_(std::filesystem::temp_directory_path() /
              ("rayloc-" + name + "." + std::to_string(::getpid()))) {
    std::filesystem::create_directories(path_);
    write("room.toml", small_room_plan());
  }
  ~SmallRoomFolder() { std::filesystem::remove_all(path_); }
  SmallRoomFolder(const SmallRoomFolder&) = delete;
  SmallRoomFolder& operator=(const SmallRoomFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name) << text;
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

}  // namespace rayloc::test
