#include <tact/lib/matrix.hpp>

int main() {
    const tact::Matrix K = tact::Matrix::identity(3);
    return K.rows() == 3 && K.cols() == 3 ? 0 : 1;
}
