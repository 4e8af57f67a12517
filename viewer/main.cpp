#include "viewer/command.h"

int main(int argc, char** argv) {
    return kokage::run_program(argc, argv);
}
