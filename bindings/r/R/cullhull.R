# Functions with the names, arguments and values of package geometry's.

as_points <- function(p, which = "first") {
  if (is.data.frame(p)) p <- as.matrix(p)
  if (!is.matrix(p) || !(is.numeric(p) || is.logical(p)))
    stop("the ", which, " argument should be a real matrix", call. = FALSE)
  if (typeof(p) != "double") storage.mode(p) <- "double"
  p
}

# Options of Qhull that ask for tolerances, or for what is always done here.
needless <- c("Pp", "Qx", "Qbb", "Qz", "Qc", "Qcc", "Qi", "Qs", "Q0", "Q3", "Q8", "Q11", "Q12",
              "Qa", "C-0", "Tc", "Tv", "Tcv", "Qt", "QJ")

# The words of both strings of options; TRUE asks for all `outputs`.
qhull_words <- function(options, output.options, outputs, others = NULL) {
  if (isTRUE(output.options)) output.options <- outputs
  if (isFALSE(output.options)) output.options <- NULL
  words <- unlist(strsplit(as.character(c(options, output.options)), "[[:space:]]+"))
  wrong <- setdiff(sub("^QJ.*", "QJ", words), c("", needless, outputs, others))
  if (length(wrong)) stop("option '", wrong[1], "' of Qhull has no meaning here", call. = FALSE)
  words
}

stop_flat <- function(p) {
  stop(nrow(p), " points that do not span ", ncol(p), " dimensions have no hull", call. = FALSE)
}

convhulln <- function(p, options = "Tv", output.options = NULL,
                      return.non.triangulated.facets = FALSE) {
  p <- as_points(p)
  to_file <- "^(.*)Fx +TO +'([^']+)'(.*)$"
  file <- if (any(grepl(to_file, options))) sub(to_file, "\\2", options)
  words <- qhull_words(sub(to_file, "\\1\\3", options), output.options, c("FA", "n"))
  whole <- isTRUE(return.non.triangulated.facets)
  n <- "n" %in% words
  # The numbers of cullhull_hull_part.
  parts <- c(hull = if (whole) 4L else 1L, ends = if (whole) 5L, facet = if (n && !whole) 3L,
             normals = if (n) 8L, vertices = if (!is.null(file)) 0L)
  h <- .Call(C_hull, p, parts)
  if (is.null(h)) stop_flat(p)
  names(h) <- c("area", "vol", names(parts))
  pointer <- attr(h$hull, "convhulln")
  if (whole) {
    sizes <- diff(h$ends)
    items <- h$hull
    h$hull <- matrix(NA_integer_, length(sizes), max(sizes))
    h$hull[cbind(rep(seq_along(sizes), sizes), sequence(sizes))] <- items
    attr(h$hull, "convhulln") <- pointer
  } else if (n) {
    h$normals <- h$normals[h$facet, , drop = FALSE]
  }
  if (!is.null(file)) writeLines(format(c(length(h$vertices), h$vertices - 1L)), file)
  if (!any(c("FA", "n") %in% words)) return(h$hull)
  wanted <- c("hull", if ("FA" %in% words) c("area", "vol"), if (n) "normals")
  structure(c(h[wanted], list(p = p)), convhulln = pointer, class = "convhulln")
}

inhulln <- function(ch, p) {
  pointer <- attr(ch, "convhulln")
  d <- ncol(.Call(C_kept, pointer))
  if (is.null(d)) stop("Convex hull has no convhulln attribute of cullhull", call. = FALSE)
  p <- as_points(p, "second")
  if (ncol(p) != d)
    stop("Number of columns in test points p (", ncol(p), ") not equal to dimension of hull (", d,
         ").", call. = FALSE)
  .Call(C_inside, pointer, p)
}

delaunayn <- function(p, options = NULL, output.options = NULL, full = FALSE) {
  p <- as_points(p)
  if (full) output.options <- TRUE
  words <- qhull_words(options, output.options, c("Fn", "Fa"), c("Qu", "FA"))
  if (nrow(p) <= ncol(p)) stop_flat(p)
  asked <- c("Fn", "Fa") %in% words
  t <- .Call(C_delaunay, p, "Qu" %in% words, asked[1], asked[2])
  names(t) <- c("tri", "neighbours", "areas")
  if (!any(asked)) return(t$tri)
  if (asked[2]) t$areas <- as.vector(t$areas)
  if (asked[1]) t$neighbours <- unname(split(t$neighbours, row(t$neighbours)))
  structure(c(t[c(TRUE, asked)], list(p = p)), delaunayn = attr(t$tri, "delaunayn"),
            class = "delaunayn")
}

halfspacen <- function(p, fp, options = "Tv") {
  qhull_words(options, NULL, NULL)
  p <- as_points(p)
  if (!is.numeric(fp) || length(fp) != ncol(p) - 1)
    stop("fp should have ", ncol(p) - 1, " coordinates", call. = FALSE)
  vertices <- .Call(C_halfspaces, p, as.double(fp))
  if (nrow(vertices) == 0 || anyNA(vertices))
    stop("the intersection of the halfspaces is unbounded", call. = FALSE)
  vertices
}

# A vertex where many facets meet is computed from each choice of them, a few units in the last
# place apart. 2^-44 of the range of each coordinate makes most of these one, and moves the volume
# about as little: intersections of hulls of birds' traits in 4D by 3e-13, in 1/18 of the time.
on_grid <- function(ps, tol) {
  grid <- if (tol > 0) tol else 2^-44 * apply(ps, 2, function(x) max(x) - min(x))
  grid[grid == 0] <- 1
  unique(t(grid * round(t(ps) / grid)))
}

intersectn <- function(ps1, ps2, tol = 0, return.chs = TRUE, options = "Tv", fp = NULL,
                       autoscale = FALSE) {
  qhull_words(options, NULL, NULL)
  ch1 <- convhulln(ps1, output.options = TRUE)
  ch2 <- convhulln(ps2, output.options = TRUE)
  if (ncol(ch1$p) != ncol(ch2$p))
    stop("ps1 and ps2 should have the same number of columns", call. = FALSE)
  planes <- rbind(ch1$normals, ch2$normals)
  ps <- if (is.null(fp)) .Call(C_halfspaces, planes, NULL) else halfspacen(planes, fp)
  if (!is.null(ps)) ps <- on_grid(ps, tol)
  empty <- is.null(ps) || is.null(.Call(C_hull, ps, integer(0)))
  out <- list(ch = if (empty) list(vol = 0) else convhulln(ps, output.options = TRUE))
  if (!return.chs) return(out)
  structure(c(list(ch1 = ch1, ch2 = ch2), if (!empty) list(ps = ps), out), class = "intersectn")
}

tsearchn <- function(x, t, xi, ...) {
  pointer <- attr(t, "delaunayn")
  if (is.list(t)) t <- t$tri
  if (is.atomic(x) && length(x) == 1 && is.na(x)) {
    x <- .Call(C_kept, pointer)
    if (is.null(x)) stop("Delaunay triangulation has no delaunayn attribute", call. = FALSE)
  }
  x <- as_points(x)
  xi <- as_points(xi, "last")
  if (!is.matrix(t) || !is.numeric(t) || ncol(t) != ncol(x) + 1)
    stop("t should be a matrix of ", ncol(x) + 1, " columns", call. = FALSE)
  if (ncol(xi) != ncol(x)) stop("xi should have ", ncol(x), " columns", call. = FALSE)
  if (anyNA(t) || any(t %% 1 != 0)) stop("t does not have integer elements", call. = FALSE)
  if (any(t < 1) || any(t > nrow(x)))
    stop("t has indexes which refer to non-existing points", call. = FALSE)
  if (typeof(t) != "integer") storage.mode(t) <- "integer"
  if (!all(is.finite(x), is.finite(xi)))
    stop("the points have values that are not finite", call. = FALSE)
  .Call(C_search, x, t, pointer, xi)
}

tsearch <- function(x, y, t, xi, yi, bary = FALSE, method = "quadtree") {
  if (length(x) != length(y)) stop("x is not same length as y", call. = FALSE)
  if (length(xi) != length(yi)) stop("xi is not same length as yi", call. = FALSE)
  found <- tsearchn(cbind(x, y, deparse.level = 0), t, cbind(xi, yi, deparse.level = 0))
  if (bary) found else found$idx
}
