cube <- as.matrix(expand.grid(0:1, 0:1, 0:1)) + 0

test_that("hulls have areas, volumes, normals and facets", {
  expect_identical(dim(convhulln(cube)), c(12L, 3L))
  ch <- convhulln(cube, output.options = TRUE)
  expect_identical(names(ch), c("hull", "area", "vol", "normals", "p"))
  expect_identical(c(ch$area, ch$vol), c(6, 1))
  beyond <- sapply(1:12, function(i) cube %*% ch$normals[i, 1:3] + ch$normals[i, 4])
  expect_equal(range(beyond), c(-1, 0))
  expect_true(all(beyond[cbind(c(t(ch$hull)), rep(1:12, each = 3))] == 0))
  whole <- convhulln(rbind(cube, 3), "FA n", return.non.triangulated.facets = TRUE)
  expect_identical(as.vector(table(rowSums(!is.na(whole$hull)))), c(6L, 3L))
  expect_identical(dim(whole$normals), c(9L, 4L))
  expect_identical(names(convhulln(cube, "Qt QJ1e-3 n")), c("hull", "normals", "p"))
  for (d in 2:6) expect_identical(nrow(convhulln(rbind(diag(d), 0))), d + 1L)
  file <- tempfile()
  convhulln(rbind(cube, 0.5), paste0("Fx TO '", file, "'"))
  expect_identical(scan(file, quiet = TRUE), c(8, 0:7))
})

test_that("points are inside hulls, also of hulls that were saved", {
  for (ch in list(convhulln(cube), convhulln(cube, "FA"))) {
    p <- rbind(0.5, c(1, 1, 0.5), c(1 + 2^-52, 0.5, 0.5), cube)
    expect_identical(inhulln(ch, p), c(TRUE, TRUE, FALSE, rep(TRUE, 8)))
    expect_identical(inhulln(unserialize(serialize(ch, NULL)), p), inhulln(ch, p))
    expect_identical(inhulln(ch, matrix(0, 0, 3)), logical(0))
    expect_error(inhulln(ch, cbind(1, 2)), "(2) not equal to dimension of hull (3).", fixed = TRUE)
  }
  for (ch in list(1, structure(1, convhulln = methods::new("externalptr"))))
    expect_error(inhulln(ch, cube), "no convhulln attribute")
})

test_that("triangulations have neighbours and volumes", {
  set.seed(1)
  p <- matrix(runif(300), ncol = 3)
  d <- delaunayn(p, output.options = TRUE)
  expect_identical(names(d), c("tri", "neighbours", "areas", "p"))
  expect_equal(sum(d$areas), convhulln(p, "FA")$vol)
  expect_gt(min(d$areas), 0)
  expect_null(dim(d$areas))
  for (i in c(1, nrow(d$tri)))
    for (k in 1:4) {
      n <- d$neighbours[[i]][k]
      if (n > 0) expect_true(all(d$tri[i, -k] %in% d$tri[n, ]))
    }
  expect_identical(sum(unlist(d$neighbours) == -1), nrow(convhulln(p)))
  expect_identical(dim(delaunayn(cbind(1:5, 1:5))), c(0L, 3L))
  expect_identical(dim(delaunayn(cube[1:4, 1:2], "Qu")), c(2L, 3L))
})

test_that("points are found in triangulations and in any mesh alike", {
  for (d in 2:4) {
    set.seed(d)
    p <- matrix(runif(60 * d), ncol = d)
    q <- rbind(matrix(runif(500 * d, -0.1, 1.1), ncol = d), p)
    t <- delaunayn(p)
    fast <- tsearchn(p, t, q)
    expect_identical(is.na(fast$idx), !inhulln(convhulln(p), q))
    plain <- t + 0L
    attr(plain, "delaunayn") <- NULL
    expect_equal(tsearchn(p, plain, q), fast)
    rows <- nrow(t):1
    columns <- (d + 1):1
    turned <- lapply(tsearchn(p, plain[rows, columns], q), utils::head, 500)
    expect_equal(rows[turned$idx], fast$idx[1:500])
    expect_equal(turned$p, fast$p[1:500, columns])
    i <- which(!is.na(fast$idx))
    back <- t(sapply(i, function(k) fast$p[k, ] %*% p[t[fast$idx[k], ], ]))
    expect_equal(back, q[i, ])
    changed <- t
    changed[1, ] <- changed[2, ]  # keeps its attribute
    attr(plain, "delaunayn") <- methods::new("externalptr")  # of another package
    expect_identical(tsearchn(p, plain, q), fast)
    expect_identical(tsearchn(p, changed, t(colMeans(p[t[1, ], ])))$idx, NA_integer_)
  }
  square <- cube[1:4, 1:2]
  expect_identical(tsearch(square[, 1], square[, 2], rbind(c(1, 2, 3)), c(0.2, 1), c(0.2, 1)),
                   c(1L, NA))
  expect_identical(tsearchn(square, rbind(c(1, 2, 2), c(3, 2, 4)), cbind(0.5, 0.5))$idx, 2L)
})

test_that("intersections have vertices and hulls", {
  half <- intersectn(cube, cube + 0.5)
  expect_identical(names(half), c("ch1", "ch2", "ps", "ch"))
  expect_equal(c(half$ch$vol, half$ch$area), c(0.125, 1.5))
  expect_identical(intersectn(cube, cube + 1)$ch, list(vol = 0))
  expect_identical(names(intersectn(cube, cube + 5, return.chs = FALSE)), "ch")
  expect_equal(intersectn(cube, cube + 0.5, fp = c(0.7, 0.7, 0.7))$ch$vol, 0.125)
  expect_error(intersectn(cube, cube + 0.5, fp = c(7, 0.7, 0.7)), "not strictly inside")
  expect_identical(intersectn(cube, cube + 0.1, tol = 0.5)$ch$vol, 1)
  set.seed(4)
  p <- matrix(rnorm(400), ncol = 4)
  inner <- p / 2
  expect_equal(intersectn(p, inner)$ch$vol, convhulln(inner, "FA")$vol)
  expect_equal(sort(halfspacen(convhulln(cube, "n")$normals, rep(0.5, 3))), sort(cube))
  expect_error(halfspacen(rbind(c(1, 0, -1)), c(0, 0)), "unbounded")
})

test_that("bad input is an error of one line", {
  for (f in list(convhulln, delaunayn, function(p) intersectn(p, p),
                 function(p) inhulln(convhulln(cube), p), function(p) halfspacen(p, 1),
                 function(p) tsearchn(cube, delaunayn(cube), p), function(p) tsearchn(p, p, p)))
    for (p in list(NULL, NA, "a", matrix("a", 3, 3), cube + c(NA, 0), cube + c(0, NaN),
                   cube + c(Inf, 0), matrix(1i, 3, 3), 1:5, list(), matrix(0, 3, 0)))
      expect_false(grepl("\n", expect_error(f(p))$message))
  for (p in list(cube[0, ], cube[1:3, ], cube[rep(1, 9), ], cbind(1:9, 1:9)))
    expect_error(convhulln(p), "have no hull")
  expect_error(delaunayn(cube[1:3, ]), "have no hull")
  for (o in list("QV3", "Fx", 3, "TO 'x'")) expect_error(convhulln(cube, o), "no meaning here")
  expect_error(delaunayn(cube, "Qu", "n"), "option 'n'")
  for (t in list(NA, "a", cbind(1, 2, 3), rbind(c(1, 2, 3, 9)), rbind(0:3), rbind(c(1:3, NA)),
                 rbind(c(1.5, 2:4))))
    expect_error(tsearchn(cube, t, cube))
  expect_error(tsearchn(NA, rbind(1:4), cube), "no delaunayn attribute")
  expect_error(tsearch(1:3, 1:2, rbind(1:3), 1, 1), "same length")
})

test_that("a long call can be interrupted", {
  set.seed(7)
  p <- matrix(rnorm(8 * 20000), ncol = 8)  # without it: minutes
  setTimeLimit(elapsed = 0.5)
  on.exit(setTimeLimit())
  expect_identical(tryCatch(convhulln(p), error = function(e) conditionMessage(e)),
                   "reached elapsed time limit")
})
