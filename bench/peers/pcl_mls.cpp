// Moving least squares of the Point Cloud Library, for bench/peers/mls: one cloud in, its projected points out.
//   pcl_mls IN.xyz OUT.xyz RADIUS ORDER
// Prints the seconds of processor time that this took, its search tree included, files not.
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/surface/mls.h>

static pcl::PointCloud<pcl::PointXYZ>::Ptr read_cloud(const char *path) {
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
  pcl::PointXYZ point;
  std::FILE *file = std::fopen(path, "r");
  while (file && std::fscanf(file, "%f %f %f", &point.x, &point.y, &point.z) == 3)
    cloud->push_back(point);
  if (file)
    std::fclose(file);
  return cloud;
}

int main(int argc, char **argv) {
  if (argc != 5) {
    std::fprintf(stderr, "usage: pcl_mls IN.xyz OUT.xyz RADIUS ORDER\n");
    return 2;
  }
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud = read_cloud(argv[1]);
  std::FILE *out = std::fopen(argv[2], "w");
  if (cloud->empty() || !out)
    return 3;
  pcl::PointCloud<pcl::PointNormal> projected;
  pcl::MovingLeastSquares<pcl::PointXYZ, pcl::PointNormal> mls;
  const std::clock_t start = std::clock();
  mls.setInputCloud(cloud);
  mls.setSearchMethod(pcl::search::KdTree<pcl::PointXYZ>::Ptr(new pcl::search::KdTree<pcl::PointXYZ>));
  mls.setComputeNormals(true);
  mls.setSearchRadius(std::atof(argv[3]));
  mls.setPolynomialOrder(std::atoi(argv[4]));
  mls.process(projected);
  std::printf("%.3f\n", static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  for (const pcl::PointNormal &point : projected)
    std::fprintf(out, "%.9g %.9g %.9g\n", point.x, point.y, point.z);
  return std::fclose(out) == 0 ? 0 : 4;
}
