library(testthat)
library(cullhull)
test_check("cullhull")
