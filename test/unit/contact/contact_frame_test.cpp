// Contact frames.
#include <gtest/gtest.h>

#include <vector>

#include "contact_test_utilities.h"
#include "tissue_contact/contact/contact.h"

namespace tissue_contact::contact_test {
namespace contact_frame_test {

TEST(ContactFrame, IsOrthonormalAndRightHandedForEveryNormal) {
  Random random(43);
  std::vector<Vector3> normals;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        if (x != 0 || y != 0 || z != 0) normals.push_back(Vector3(x, y, z).normalized());
      }
    }
  }
  for (int i = 0; i < 1000; ++i) normals.push_back(random.direction());
  const Vector3 worst = -Vector3(2.0, 3.0, 6.0) / 7.0;  // the one direction without an answer, and close to it
  for (const double off : {0.0, 1e-17, 1e-14, 1e-11, 1e-8, 1e-4}) {
    normals.push_back((worst + off * random.direction()).normalized());
  }
  for (const Vector3& n : normals) {
    const Matrix3 R = contactFrame(n);
    EXPECT_EQ(Vector3(R.col(0)), n);
    EXPECT_LT((R.transpose() * R - Matrix3::Identity()).norm(), 1e-14) << n.transpose();
    EXPECT_NEAR(R.determinant(), 1.0, 1e-14);
  }
}

TEST(ContactFrame, ChangesLittleWithTheNormal) {
  Random random(44);
  const double step = 1e-6;
  for (int i = 0; i < 1000; ++i) {
    const Vector3 n = random.direction();
    if (n.dot(Vector3(2.0, 3.0, 6.0) / 7.0) < -0.99) continue;
    const Vector3 other = (n + step * random.direction()).normalized();
    EXPECT_LT((contactFrame(n) - contactFrame(other)).norm(), 20.0 * step);
  }
}

}  // namespace contact_frame_test
}  // namespace tissue_contact::contact_test
