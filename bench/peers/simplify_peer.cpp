// Simplifies an OBJ by meshoptimizer: simplify_peer IN.obj TRIANGLES OUT.obj
// Texture coordinates are kept. Only the bench builds it (bench/peers/simplify).
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <meshoptimizer.h>

struct Mesh {
  std::vector<float> position;    // 3 a vertex
  std::vector<float> coordinates; // 2 a vertex, or none
  std::vector<unsigned> corners;  // 3 a triangle
};

// A corner as "v", "v/vt" or "v/vt/vn"; numbers count from 1.
static std::pair<int, int> corner_in_word(const std::string &word) {
  size_t slash = word.find('/');
  int v = std::atoi(word.c_str()), vt = slash == std::string::npos ? 0 : std::atoi(word.c_str() + slash + 1);
  return {v, vt};
}

static Mesh read_peer_mesh(const char *name) {
  std::ifstream in(name);
  std::vector<float> v, vt;
  std::map<std::pair<int, int>, unsigned> numbers;
  Mesh mesh;
  for (std::string line, kind, word; std::getline(in, line);) {
    std::istringstream words(line);
    kind.clear();
    words >> kind;
    if (kind == "v" || kind == "vt") {
      float value;
      for (int k = 0; k < (kind == "v" ? 3 : 2) && words >> value; k++)
        (kind == "v" ? v : vt).push_back(value);
    } else if (kind == "f") {
      std::vector<unsigned> face;
      while (words >> word) {
        std::pair<int, int> corner = corner_in_word(word);
        auto found = numbers.emplace(corner, static_cast<unsigned>(mesh.position.size() / 3));
        face.push_back(found.first->second);
        if (!found.second)
          continue;
        for (int k = 0; k < 3; k++)
          mesh.position.push_back(v[3 * static_cast<size_t>(corner.first - 1) + static_cast<size_t>(k)]);
        for (int k = 0; k < 2 && corner.second > 0; k++)
          mesh.coordinates.push_back(vt[2 * static_cast<size_t>(corner.second - 1) + static_cast<size_t>(k)]);
      }
      for (size_t k = 2; k < face.size(); k++)
        mesh.corners.insert(mesh.corners.end(), {face[0], face[k - 1], face[k]});
    }
  }
  return mesh;
}

// Leaves out the vertices that no triangle has.
static void leave_out_unused(Mesh &mesh) {
  size_t n = mesh.position.size() / 3;
  std::vector<unsigned> numbers(n);
  n = meshopt_optimizeVertexFetchRemap(numbers.data(), mesh.corners.data(), mesh.corners.size(), n);
  meshopt_remapIndexBuffer(mesh.corners.data(), mesh.corners.data(), mesh.corners.size(), numbers.data());
  meshopt_remapVertexBuffer(mesh.position.data(), mesh.position.data(), numbers.size(), 3 * sizeof(float),
                            numbers.data());
  mesh.position.resize(3 * n);
  if (mesh.coordinates.empty())
    return;
  meshopt_remapVertexBuffer(mesh.coordinates.data(), mesh.coordinates.data(), numbers.size(), 2 * sizeof(float),
                            numbers.data());
  mesh.coordinates.resize(2 * n);
}

static void write_peer_mesh(const char *name, const Mesh &mesh) {
  std::ofstream out(name);
  bool has_coordinates = !mesh.coordinates.empty();
  size_t n = mesh.position.size() / 3;
  out.precision(9);
  for (size_t i = 0; i < n; i++)
    out << "v " << mesh.position[3 * i] << ' ' << mesh.position[3 * i + 1] << ' ' << mesh.position[3 * i + 2] << '\n';
  for (size_t i = 0; i < n && has_coordinates; i++)
    out << "vt " << mesh.coordinates[2 * i] << ' ' << mesh.coordinates[2 * i + 1] << '\n';
  for (size_t i = 0; i < mesh.corners.size(); i += 3) {
    out << 'f';
    for (size_t k = i; k < i + 3; k++) {
      out << ' ' << mesh.corners[k] + 1;
      if (has_coordinates)
        out << '/' << mesh.corners[k] + 1;
    }
    out << '\n';
  }
}

int main(int n, char **words) {
  if (n != 4) {
    std::fprintf(stderr, "usage: simplify_peer IN.obj TRIANGLES OUT.obj\n");
    return 2;
  }
  Mesh mesh = read_peer_mesh(words[1]);
  size_t wanted = 3 * static_cast<size_t>(std::atol(words[2]));
  std::vector<unsigned> made(mesh.corners.size());
  made.resize(meshopt_simplify(made.data(), mesh.corners.data(), mesh.corners.size(), mesh.position.data(),
                               mesh.position.size() / 3, 3 * sizeof(float), wanted, 1e9f, 0, nullptr));
  mesh.corners = made;
  leave_out_unused(mesh);
  write_peer_mesh(words[3], mesh);
  std::printf("%zu\n", made.size() / 3);
  return 0;
}
