// Tables as offices, maps and scanners write them: each is read right or refused with a sentence
// that shows the way, whole and in blocks.

#include "cullhull/point_blocks.hpp"
#include "tests/io_fixtures.hpp"
#include "thrown.hpp"

namespace cullhull::testing::io_tables_test {

struct Table {
  std::string name, file, text;
  Rows rows;            ///< empty: the table is refused ...
  std::string says;     ///< ... and this is in the message; else in a remark, "" for no remark
  std::string columns;  ///< as PointFile::columns(), joined by commas
};

std::string utf16(const std::string& text, bool big) {
  std::string out = big ? "\xFE\xFF" : "\xFF\xFE";
  for (const char c : text) {
    const std::string pair{c, '\0'};
    out += big ? std::string{pair[1], pair[0]} : pair;
  }
  return out;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ",") + word;
  return text;
}

const Rows refused;
Rows row(const std::vector<double>& only) { return {only}; }
const Rows plane{{1.5, 2.5}, {3.5, 4.5}, {5.5, 1.5}};
const Rows space{{1, 2, 3}, {4, 5, 6}};

std::vector<Table> tables() {
  const std::string choose = "--columns takes some by name or by number from 0";
  return {
      // Decimal commas.
      {"tabs and commas", "z.txt", "x\ty\n1,5\t2,5\n3,5\t4,5\n5,5\t1,5\n", plane, "decimal marks",
       "x,y"},
      {"without names", "z.txt", "1,5\t2,5\n3,5\t4,5\n5,5\t1,5\n", plane, "decimal marks", "0,1"},
      {"semicolons", "z.csv", "x;y\n1,5;2,5\n3,5;4,5\n5,5;1,5\n", plane, "decimal marks", "x,y"},
      {"commas come later", "z.csv", "x;y\n1;2\n1,5;2,5\n", Rows{{1, 2}, {1.5, 2.5}},
       "decimal marks", "x,y"},
      {"semicolons without names", "z.csv", "1,5;2,5\n3,5;4,5\n5,5;1,5\n", plane, "decimal marks",
       "0,1"},
      {"names between blanks", "z.txt", "x y\n1,5 2,5\n3,5 4,5\n5,5 1,5\n", plane, "decimal marks",
       "x,y"},
      {"quoted decimals", "z.csv",
       "\"x\",\"y\"\n\"1,5\",\"2,5\"\n\"3,5\",\"4,5\"\n\"5,5\",\"1,5\"\n", plane, "decimal marks",
       "x,y"},
      {"blanks and commas", "z.txt", "1,5 2,5\n3,5 4,5\n", refused, "--decimal , reads", ""},
      {"commas alone", "z.csv", "x,y\n1,5,2,5\n", refused, "another separator", ""},
      {"one column", "z.csv", "x\n1,5\n", row({1.5}), "decimal marks", "x"},
      {"one column in a table of two", "z.csv", "x\n1,5 2,5\n", refused, "--decimal , reads", ""},
      {"a point and commas", "z.csv", "x;y\n1.5;2\n1,5;2\n", refused,
       "commas are the decimal marks", ""},
      {"thousands", "z.csv", "x;y\n1.234,5;2\n", refused, "both ',' and ';'", ""},
      {"comma and blank", "z.csv", "x, y, z\n1, 2, 3\n4, 5, 6\n", space, "", "x,y,z"},
      {"comma and tab", "z.txt", "1,\t2,\t3\n4,\t5,\t6\n", space, "", "0,1,2"},
      {"aligned commas", "z.txt", "1 ,2 ,3\n4 ,5 ,6\n", space, "", "0,1,2"},
      {"two separators", "z.txt", "1;2;3\n4,5,6\n", refused, "other separators", ""},
      {"Excel's first line", "sep.csv", "sep=;\nx;y;z\n1;2;3\n4;5;6\n", space, "", "x,y,z"},
      {"Excel's first line, comma", "sep.csv", "sep=,\r\nx,y,z\r\n1,2,3\r\n4,5,6\r\n", space, "",
       "x,y,z"},
      {"Excel in German", "punkte.csv",
       "Punkt;Rechtswert;Hochwert;H\xC3\xB6he\nP1;1,5;2,5;3,5\nP2;4,5;5,5;6,5\n",
       Rows{{1.5, 2.5, 3.5}, {4.5, 5.5, 6.5}}, "of 4 columns", "Rechtswert,Hochwert,H\xC3\xB6he"},
      {"in Latin-1", "punkte.csv", "Punkt;Ost;Nord;H\xF6he\nP1;1;2;3\nP2;4;5;6\n", space,
       "of 4 columns", "Ost,Nord,H\xC3\xB6he"},
      {"Excel in French", "points.csv", "N\xC2\xB0;Est;Nord;Altitude\n1;1,5;2;3\n",
       row({1.5, 2, 3}), "decimal marks", "Est,Nord,Altitude"},
      // Widths.
      {"x,y and three", "a.csv", "x,y\n1,2,3\n", refused, "--columns 1:3 leaves it out", ""},
      {"x,y,z and two", "a.csv", "x,y,z\n1,2\n", refused, "2 columns where line 1 names 3", ""},
      {"lon,lat and three", "a.csv", "lon,lat\n1,2,3\n", refused, "3 columns where line 1 names 2",
       ""},
      {"unknown and more", "a.csv", "u,v\n1,2,3,4\n", refused, "--columns 0:4", ""},
      {"a later row", "a.csv", "x,y\n1,2\n1,2,3\n", refused, "3 coordinates where", ""},
      {"between blanks", "a.txt", "x y\n1 2 3\n", refused, "3 columns where line 1 names 2", ""},
      {"R's names of rows", "r.txt", "\"x\" \"y\"\n\"1\" 1.5 2.5\n\"2\" 3.5 4.5\n\"3\" 5.5 1.5\n",
       plane, "x and y of 3 columns", "x,y"},
      {"R's names of rows, unquoted", "r.txt", "x y\n1 1.5 2.5\n", refused,
       "as R writes names of rows", ""},
      {"R's write.csv", "r.csv", "\"\",\"x\",\"y\"\n\"1\",1.5,2.5\n\"2\",3.5,4.5\n\"3\",5.5,1.5\n",
       plane, "x and y of 3 columns", "x,y"},
      {"R's V1 V2", "r.csv", "\"\",\"V1\",\"V2\"\n\"1\",1.5,2.5\n\"2\",3.5,4.5\n\"3\",5.5,1.5\n",
       plane, "'V1', 'V2' are taken as coordinates, not ''", "V1,V2"},
      {"names with blanks, rows with commas", "a.txt", "x y z\n1,2,3\n4,5,6\n", space, "", "x,y,z"},
      {"names with commas, rows with blanks", "a.txt", "x,y,z\n1 2 3\n4 5 6\n", space, "", "x,y,z"},
      // Names.
      {"ArcGIS", "a.csv", "OBJECTID,POINT_X,POINT_Y\n1,1.5,2.5\n2,3.5,4.5\n3,5.5,1.5\n", plane,
       "POINT_X and POINT_Y of 3 columns", "POINT_X,POINT_Y"},
      {"ArcGIS, turned", "a.csv", "POINT_Y,POINT_X\n2,1\n", row({1, 2}), "in this order",
       "POINT_X,POINT_Y"},
      {"ArcGIS with heights", "a.csv", "FID,POINT_X,POINT_Y,POINT_Z\n1,1,2,3\n2,4,5,6\n", space,
       "of 4 columns", "POINT_X,POINT_Y,POINT_Z"},
      {"QGIS", "a.csv", "X,Y,id,name\n1.5,2.5,7,a\n3.5,4.5,8,\"b, c\"\n5.5,1.5,9,\n", plane,
       "X and Y of 4 columns", "X,Y"},
      {"QGIS's WKT", "a.csv", "WKT,id\n\"POINT (1 2)\",7\n", refused,
       "'WKT' holds geometries in WKT", ""},
      {"No., a, b", "a.csv", "No.,a,b\n1,2,3\n", row({2, 3}), "not 'No.'", "a,b"},
      {"Point, a, b", "a.csv", "Point,a,b\n1,2,3\n", row({2, 3}), "not 'Point'", "a,b"},
      {"nothing known", "a.csv", "size,mass,price\n1,2,3\n", refused,
       "'size', 'mass', 'price'; " + choose + ", as --columns size,mass,price or --columns 0,1,2",
       ""},
      {"id and unknown", "a.csv", "id,mass,price\n1,2,3\n", refused, "--columns mass,price", ""},
      {"iris", "a.csv", "sepal_length,sepal_width,species\n5.1,3.5,setosa\n", refused,
       "--columns sepal_length,sepal_width or --columns 0,1", ""},
      {"CloudCompare", "a.asc", "//X Y Z R G B\n1 2 3 255 0 0\n4 5 6 0 255 0\n", space,
       "X, Y and Z of 6 columns", "X,Y,Z"},
      {"CloudCompare with a count", "cc.txt",
       "//X;Y;Z;Rf;Gf;Bf;Intensity\n2\n1;2;3;1;0.97;0.98;0.5\n4;5;6;0.9;0.9;0.9;0.4\n", space,
       "X, Y and Z of 7 columns", "X,Y,Z"},
      {"a comment of x y z alone", "a.xyz", "# x y z\n1 2 3 255 0 0\n", refused, "--columns 0:3",
       ""},
      {"a comment that talks", "a.xyz", "# the x and y of it\n1 2 3\n4 5 6\n", space, "", "0,1,2"},
      {"colours", "a.xyz", "1.5 2 3 255 0 0\n4 5 6 0 255 0\n",
       Rows{{1.5, 2, 3, 255, 0, 0}, {4, 5, 6, 0, 255, 0}}, "--columns 0:3", "0,1,2,3,4,5"},
      {"lat,lng", "a.csv", "lat,lng\n2,1\n", row({1, 2}), "in this order", "lng,lat"},
      {"lat,long", "a.csv", "lat,long\n2,1\n", row({1, 2}), "in this order", "long,lat"},
      {"lat_dd,lon_dd", "a.csv", "lat_dd,lon_dd\n2,1\n", row({1, 2}), "in this order",
       "lon_dd,lat_dd"},
      {"north,east", "a.csv", "north,east\n2,1\n", row({1, 2}), "in this order", "east,north"},
      {"GBIF", "a.csv", "decimalLatitude,decimalLongitude\n2,1\n", row({1, 2}), "in this order",
       "decimalLongitude,decimalLatitude"},
      {"GBIF's download", "a.tsv",
       "gbifID\tspecies\tdecimalLatitude\tdecimalLongitude\n"
       "77\tParus major\t2\t1\n78\t\t4\t3\n",
       Rows{{1, 2}, {3, 4}}, "of 4 columns", "decimalLongitude,decimalLatitude"},
      {"E, N", "a.csv", "N,E\n2,1\n", row({1, 2}), "in this order", "E,N"},
      {"Ost;Nord", "a.csv", "Nord;Ost\n2;1\n", row({1, 2}), "in this order", "Ost,Nord"},
      {"Hochwert", "a.csv", "HOCHWERT;RECHTSWERT\n2;1\n", row({1, 2}), "in this order",
       "RECHTSWERT,HOCHWERT"},
      {"x_coord", "a.csv", "y_coord,x_coord\n2,1\n", row({1, 2}), "in this order",
       "x_coord,y_coord"},
      {"units in brackets", "a.csv", "Y [m],X [m],Z [m]\n2,1,3\n", row({1, 2, 3}), "in this order",
       "X [m],Y [m],Z [m]"},
      {"units in parentheses", "a.csv", "Y (m),X (m)\n2,1\n", row({1, 2}), "in this order",
       "X (m),Y (m)"},
      {"x_m", "a.csv", "y_m,x_m\n2,1\n", row({1, 2}), "in this order", "x_m,y_m"},
      {"UTM", "a.csv", "utm_n,utm_e\n2,1\n", row({1, 2}), "in this order", "utm_e,utm_n"},
      {"Swiss", "a.csv", "E_LV95;N_LV95;Hoehe [m]\n1;2;3\n4;5;6\n", space, "",
       "E_LV95,N_LV95,Hoehe [m]"},
      {"French", "a.csv", "Y_L93;X_L93;Z_NGF\n2;1;3\n", row({1, 2, 3}), "in this order",
       "X_L93,Y_L93,Z_NGF"},
      {"Spanish", "a.csv", "Norte;Este;Cota\n2;1;3\n", row({1, 2, 3}), "in this order",
       "Este,Norte,Cota"},
      {"German coordinates", "a.csv", "ykoord;xkoord\n2;1\n", row({1, 2}), "in this order",
       "xkoord,ykoord"},
      {"GNSS", "a.csv", "Name,Latitude,Longitude,Ellipsoidal Height\nP1,2,1,3\nP2,5,4,6\n", space,
       "of 4 columns", "Longitude,Latitude,Ellipsoidal Height"},
      {"a member of JSON", "a.csv", "location.lat,location.lng\n2,1\n", row({1, 2}),
       "in this order", "location.lng,location.lat"},
      {"two systems", "a.csv", "lat,lon,POINT_X,POINT_Y\n2,1,9,8\n", row({1, 2}), "of 4 columns",
       "lon,lat"},
      {"degrees and minutes", "a.csv", "lat_deg,lat_min,lon_deg,lon_min\n2,30,1,30\n", refused,
       "not known as coordinates", ""},
      {"other quantities of x and y", "a.csv", "id,x_velocity,y_velocity\n1,2,3\n", refused,
       "not known as coordinates", ""},
      {"corners of boxes", "a.csv", "xmin,ymin,xmax,ymax\n1,2,3,4\n", refused,
       "not known as coordinates", ""},
      {"twice", "a.csv", "x,x,y\n1,2,3\n", refused, "'x', 'x', 'y'", ""},
      {"a height beside x and y", "a.csv", "x,y,Elevation\n1.5,2.5,9\n3.5,4.5,9\n5.5,1.5,9\n",
       plane, "not 'Elevation'", "x,y"},
      {"Trimble", "t.csv", "Point,Northing,Easting,Elevation,Code\nP1,2,1,3,TREE\nP2,5,4,6,\n",
       space, "of 5 columns", "Easting,Northing,Elevation"},
      {"Trimble without names", "t.csv", "P1,2,1,3,TREE\n", refused, "--columns 1,2,3", ""},
      {"Leica", "l.txt", "PtID\tEast\tNorth\tHeight\nA1\t1\t2\t3\nA2\t4\t5\t6\n", space,
       "of 4 columns", "East,North,Height"},
      {"PDAL", "p.txt", "\"X\",\"Y\",\"Z\",\"Intensity\"\n1.00,2.00,3.00,7\n4.00,5.00,6.00,8\n",
       space, "X, Y and Z of 4 columns", "X,Y,Z"},
      {"years beside lon and lat", "a.csv", "lon,lat,2019,2020\n1,2,7,8\n", row({1, 2}),
       "lon and lat of 4 columns", "lon,lat"},
      // Series.
      {"x0 x1 x2 x3", "a.csv", "x0,x1,x2,x3\n1,2,3,4\n", row({1, 2, 3, 4}), "", "x0,x1,x2,x3"},
      {"dim_0", "a.csv", "dim_0,dim_1\n1,2\n", row({1, 2}), "", "dim_0,dim_1"},
      {"PC1", "a.csv", ",PC1,PC2\ns1,1,2\n", row({1, 2}), "not ''", "PC1,PC2"},
      {"a,b,c", "a.csv", "a,b,c\n1,2,3\n4,5,6\n", space, "", "a,b,c"},
      {"x,y,z,w", "a.csv", "x,y,z,w\n1,2,3,4\n", row({1, 2, 3, 4}), "are taken", "x,y,z,w"},
      {"x,y,z and words", "a.csv", "x,y,z,w\n1,2,3,word\n4,5,6,\n", space, "of 4 columns", "x,y,z"},
      {"x,y,z,i", "a.csv", "x,y,z,i\n1,2,3,4\n4,5,6,4\n", space, "of 4 columns", "x,y,z"},
      {"a stem", "a.csv", "vel_x,vel_y,vel_z\n1,2,3\n4,5,6\n", space, "", "vel_x,vel_y,vel_z"},
      {"not a series", "a.csv", "v1,v3\n1,2\n", refused, "not known as coordinates", ""},
      {"pandas", "a.csv", ",x,y,z\n0,1,2,3\n1,4,5,6\n", space, "of 4 columns", "x,y,z"},
      {"pandas without names", "a.csv", ",0,1,2\n0,1,2,3\n1,4,5,6\n", space, "not ''", "0,1,2"},
      {"one column of any name", "a.csv", "depth\n1\n2\n", Rows{{1}, {2}}, "", "depth"},
      // Lines of other things.
      {"units below", "a.csv", "x,y,z\nm,m,m\n1,2,3\n4,5,6\n", space, "units", "x,y,z"},
      {"units in brackets below", "a.csv", "lon;lat\n[\xC2\xB0];[\xC2\xB0]\n1;2\n", row({1, 2}),
       "units", "lon,lat"},
      {"words below", "a.csv", "x,y\nfoo,bar\n1,2\n", refused, "'foo' is not a number", ""},
      {"unknown names between blanks", "a.txt", "A B C\n1 2 3\n4 5 6\n", space, "", "A,B,C"},
      {"unknown words between tabs", "a.txt", "Point\tEast\tNorth\nA\t1\t2\n", row({1, 2}),
       "of 3 columns", "East,North"},
      {"unknown words", "a.txt", "Mass Price\n1 2\n", refused, "--columns Mass,Price", ""},
      {"letters", "a.csv",
       "L\xC3\xA4nge;Gr\xC3\xB6\xC3\x9F"
       "e\n1;2\n",
       refused,
       "'L\xC3\xA4nge', 'Gr\xC3\xB6\xC3\x9F"
       "e'",
       ""},
      {"UTF-16, little-endian", "u.csv", utf16("x,y\n1.5,2.5\n3.5,4.5\n5.5,1.5\n", false), plane,
       "", "x,y"},
      {"UTF-16, big-endian", "u.txt", utf16("1.5\t2.5\n3.5\t4.5\n5.5\t1.5\n", true), plane, "",
       "0,1"},
      {"line ends of old Macs", "a.csv", "x,y\r1,2\r3,4\r", refused, "a carriage return within",
       ""},
      {"rows of old Macs", "a.txt", "1 2\r3 4\r", refused, "a carriage return within", ""},
      {"numbers of columns", "a.csv", "0,1,2\n4,5,6\n", Rows{{0, 1, 2}, {4, 5, 6}},
       "if it numbers the columns", "0,1,2"},
      {"numbers of rows", "a.csv", "1,7,2\n2,6,3\n3,5,4\n4,4,4\n",
       Rows{{1, 7, 2}, {2, 6, 3}, {3, 5, 4}, {4, 4, 4}}, "--columns 1:3 leaves it out", "0,1,2"},
      {"a count", "count.xyz", "2\n1 2 3\n4 5 6\n", space, "", "0,1,2"},
      {"a count and more than coordinates", "count.txt", "2\n1 2 3 7\n4 5 6 8\n",
       Rows{{1, 2, 3, 7}, {4, 5, 6, 8}}, "--columns 0:3", "0,1,2,3"},
      {"a word above a column", "a.txt", "value\n1\n2\n", Rows{{1}, {2}}, "", "value"},
      {"a title", "a.txt", "Points\n1 2\n3 4\n", refused, "2 columns where line 1 names 1", ""},
      {"a count that is not so", "count.xyz", "3\n1 2 3\n4 5 6\n", refused, "promises 3 points",
       ""},
      {"a count of a column", "count.txt", "3\n1\n2\n5\n", Rows{{1}, {2}, {5}}, "number of points",
       "0"},
      {"Leica's .pts", "c.pts", "2\n1 2 3 7 117 130 149\n4 5 6 8 117 130 149\n", space,
       "first three of 7", "0,1,2"},
      {"a .pts with intensities", "c.pts", "2\n1 2 3 -7\n4 5 6 8\n", space, "first three of 4",
       "0,1,2"},
      {"a .pts of the plane", "c.pts", "1.5 2.5\n3.5 4.5\n5.5 1.5\n", plane, "", "0,1"},
      {"TetGen", "t.node", "2 3 0 0\n1 1 2 3\n2 4 5 6\n# Generated by tetgen\n", space, "",
       "x,y,z"},
      {"Triangle", "t.node", "# a\n3 2 1 1\n0 1.5 2.5 9 1 # b\n1 3.5 4.5 9 0\n2 5.5 1.5 9 1\n",
       plane, "", "x,y"},
      {"Triangle by another name", "t.txt", "3 2 1 0\n1 1.5 2.5 9\n2 3.5 4.5 9\n3 5.5 1.5 9\n",
       plane, "", "x,y"},
      {"a .node cut short", "t.node", "3 2 0 0\n1 1.5 2.5\n", refused, "promises 3 points", ""},
      {"a .node of something else", "t.node", "1.5 2.5\n", refused, "a .node begins with", ""},
      {"rows of JSON", "a.json", "[[1.5, 2.5],\n [3.5, 4.5], [5.5, 1.5]]\n", plane, "", "0,1"},
      {"rows of JSON in an object", "a.json",
       "{\"name\": \"a\", \"points\": [[1, 2, 3], [4, 5, 6]], \"more\": [[1], {}]}", space, "",
       "0,1,2"},
      {"rows of JSON that differ", "a.json", "[[1, 2], [3]]", refused,
       "row 1 of a list of points has 1", ""},
      {"objects of JSON", "a.json", "[{\"x\": 1}]", refused, "an object where", ""},
      {"Leica's .ptx", "s.ptx",
       "2\n2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n10 20 30 1\n"
       "1 2 3 0.5\n0 0 0 0.5\n0 0 0 0.5\n4 5 6 0.5\n"
       "1\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n0 1 0 0\n-1 0 0 0\n0 0 1 0\n0 0 0 1\n"
       "1 2 3 0.5 255 0 0\n",
       Rows{{11, 22, 33}, {14, 25, 36}, {-2, 1, 3}}, "2 records without a return", "x,y,z"},
      {"a .ptx cut short", "s.ptx",
       "2\n2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 2 3 0.5\n", refused,
       "ends after 1 of the 4 records", ""},
  };
}

struct Seen {
  Rows rows;
  std::string error, remarks, columns;
};

Seen read_whole(const std::string& path, ReadOptions options) {
  Seen seen;
  options.remark = [&](const Remark& remark) { seen.remarks += remark.message + "\n"; };
  try {
    const PointFile file = open_points(path, options);
    seen.rows = rows_of(file.points());
    seen.columns = joined(file.columns());
  } catch (const Error& e) {
    seen.error = e.what();
  }
  return seen;
}

Seen read_in_blocks(const std::string& path, ReadOptions options) {
  Seen seen;
  options.remark = [&](const Remark& remark) { seen.remarks += remark.message + "\n"; };
  try {
    std::map<std::uint64_t, Rows> found;
    std::mutex mutex;
    BlockVisitor visitor;
    visitor.points = [&](const PointView& block, std::uint64_t first) {
      const std::lock_guard lock(mutex);
      found[first] = rows_of(block);
    };
    BlockOptions blocks;
    blocks.read = options;
    blocks.block_bytes = 8;
    blocks.readers = 2;
    seen.columns = joined(visit_blocks({path}, visitor, blocks).columns);
    for (const auto& [first, part] : found)
      seen.rows.insert(seen.rows.end(), part.begin(), part.end());
  } catch (const Error& e) {
    seen.error = e.what();
  }
  return seen;
}

TEST(Tables, ReadRightOrRefusedWithAWay) {
  const TemporaryFolder folder;
  ASSERT_GE(tables().size(), 60U);
  for (const Table& table : tables()) {
    SCOPED_TRACE(table.name);
    const std::string path = folder.write(table.file, table.text);
    const Seen whole = read_whole(path, {}), blocks = read_in_blocks(path, {});
    EXPECT_EQ(whole.rows, table.rows) << whole.error;
    EXPECT_EQ(blocks.rows, table.rows) << blocks.error;
    EXPECT_EQ(whole.error, blocks.error);
    EXPECT_EQ(whole.remarks, blocks.remarks);
    EXPECT_EQ(whole.columns, table.columns);
    EXPECT_EQ(blocks.columns, table.columns);
    const std::string& said = table.rows.empty() ? whole.error : whole.remarks;
    if (table.says.empty())
      EXPECT_EQ(said, "");
    else
      EXPECT_TRUE(has(said, table.says));
  }
}

ReadOptions with(const std::string& columns, char decimal = 0) {
  ReadOptions options;
  options.columns = columns;
  options.decimal = decimal;
  return options;
}

TEST(Tables, DecimalMarkAsAsked) {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& text, const std::string& columns, char decimal) {
    const std::string path = folder.write("d.txt", text);
    const Seen whole = read_whole(path, with(columns, decimal)),
               blocks = read_in_blocks(path, with(columns, decimal));
    EXPECT_EQ(whole.rows, blocks.rows) << text;
    EXPECT_EQ(whole.error, blocks.error) << text;
    EXPECT_EQ(whole.remarks, "") << text;
    return whole;
  };
  EXPECT_EQ(read("1,5 2,5\n3,5 4,5\n5,5 1,5\n", "", ',').rows, plane);
  EXPECT_EQ(read("1,5;2,5\n3,5;4,5\n5,5;1,5\n", "", ',').rows, plane);
  EXPECT_EQ(read("a 1,5 2,5\nb 3,5 4,5\nc 5,5 1,5\n", "1:", ',').rows, plane);
  EXPECT_EQ(read("2\n3\n1,5 2,5\n3,5 4,5\n5,5 1,5\n", "", ',').rows, plane);  // Qhull's header
  EXPECT_EQ(read("1,5\n-,5\n+1,\n", "", ',').rows, (Rows{{1.5}, {-0.5}, {1}}));
  EXPECT_EQ(read("1,5\t2,5\n", "", '.').rows, Rows());
  EXPECT_TRUE(has(read("1,5;2,5\n", "", '.').error, "both ',' and ';'"));
  EXPECT_TRUE(has(read("1.5 2\n", "", ',').error, "commas are the decimal marks"));
  EXPECT_TRUE(has(read("1,5 1e999\n", "", ',').error, "range"));
  const std::string obj = folder.write("a.obj", "v 1 2 3\n");
  EXPECT_TRUE(has(read_whole(obj, with("", ',')).error, "only texts of rows"));
  EXPECT_TRUE(has(read_in_blocks(obj, with("", ',')).error, "only texts of rows"));
  EXPECT_TRUE(has(read_whole(obj, with("", 'x')).error, "a decimal mark is"));
}

TEST(Tables, ColumnsByNumberNeedNoKnownNames) {
  const TemporaryFolder folder;
  for (const auto& [text, columns, want] : std::vector<std::tuple<const char*, const char*, Rows>>{
           {"Mass\tPrice\n1\t2\n", "0,1", {{1, 2}}},
           {"Mass\tPrice\n1\t2\n", "price,0", {{2, 1}}},
           {"Mass Price Name\n1 2 a\n", "0:2", {{1, 2}}},
           {"x,y\n7,1,2\n", "1:", {{1, 2}}},
           {"size,mass\n1,2\n", "mass", {{2}}},
           {"size,mass\n1,2\n", "size,mass", {{1, 2}}},
           {"x,y\n1,2\n", "x,y", {{1, 2}}},
           {"x\ty\n1,5\t2,5\n", "x,y", {{1.5, 2.5}}},
           {"# x y z\n1 2 3 255\n", "0:3", {{1, 2, 3}}},
           {"2\n1 2 3 9\n4 5 6 9\n", "0:3", space},
           {"3 2 1 0\n1 1.5 2.5 9\n2 3.5 4.5 8\n3 5.5 1.5 7\n", "attribute1", {{9}, {8}, {7}}}}) {
    const std::string path = folder.write("c.txt", text);
    EXPECT_EQ(read_whole(path, with(columns)).rows, want) << text;
    EXPECT_EQ(read_in_blocks(path, with(columns)).rows, want) << text;
    EXPECT_EQ(read_whole(path, with(columns)).error, "") << text;
  }
}

// What is found in the first rows is found in blocks, too, behind long comments.
TEST(Tables, LongCommentsBeforeTheNames) {
  const TemporaryFolder folder;
  for (const std::size_t bytes : {1000U, 1048000U, 1048570U, 3000000U}) {
    std::string text = "#";
    while (text.size() < bytes) text.append(99, 'c').append("\n#");
    text += "\nx;y\n";
    for (int i = 0; i < 1000; ++i) text += std::to_string(i) + ";0\n";
    text += "1,5;2,5\n";
    const std::string path = folder.write("c.csv", text);
    const Seen whole = read_whole(path, {}), blocks = read_in_blocks(path, {});
    EXPECT_EQ(whole.rows.size(), 1001U) << whole.error;
    EXPECT_EQ(whole.rows, blocks.rows) << blocks.error;
    EXPECT_EQ(whole.remarks, blocks.remarks);
  }
}

// Commas that come after the rows that are looked at first are refused, not taken apart.
TEST(Tables, DecimalCommasThatComeLate) {
  const TemporaryFolder folder;
  std::string text = "x;y\n";
  for (int i = 0; i < 20000; ++i) text += std::to_string(i) + ";0\n";
  const std::string path = folder.write("c.csv", text + "1,5;2,5\n");
  const Seen whole = read_whole(path, {}), blocks = read_in_blocks(path, {});
  EXPECT_TRUE(has(whole.error, ":20002: both ',' and ';' separate numbers; --decimal , reads"));
  EXPECT_EQ(whole.error, blocks.error);
}

TEST(Tables, OfManyDimensions) {
  const TemporaryFolder folder;
  std::string names, row;
  for (int j = 0; j < 5000; ++j) {
    names += (j > 0 ? "," : "") + ("c" + std::to_string(j));
    row += (j > 0 ? "," : "") + std::to_string(j);
  }
  const std::string path = folder.write("m.csv", names + "\n" + row + "\n");
  EXPECT_EQ(read_whole(path, {}).rows[0].size(), 5000U);
  EXPECT_EQ(read_in_blocks(path, {}).rows, read_whole(path, {}).rows);
}

}  // namespace cullhull::testing::io_tables_test
